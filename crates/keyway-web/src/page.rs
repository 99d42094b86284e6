//! The state of a page, and its answers.

use crate::drive::{self, Drive};
use crate::error::{Kind, PageError};
use crate::map::{self, EditMap, OpenMap, Opened};
use crate::message::{Message, json};
use crate::names::Names;
use crate::route::{self, Layers, Plan};
use keyway::search::Workspace;
use serde::{Deserialize, Serialize};

/// Everything that a page has open.
#[derive(Debug, Default)]
pub struct Page {
    map: Option<Opened>,
    layers: Layers,
    workspace: Workspace,
}

/// A question.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
enum Question {
    Names,
    OpenMap(OpenMap),
    EditMap(EditMap),
    Plan(Plan),
    Search(Plan),
    Drive(Box<Drive>),
}

/// The head of an answer to a question that has none.
#[derive(Serialize)]
struct Refusal {
    error: PageError,
}

impl Page {
    /// The answer to a question; an error is an answer, too, and changes nothing.
    pub fn answer(&mut self, message: &Message) -> Message {
        let question = serde_json::from_str(&message.head)
            .map_err(|error| PageError::new(Kind::Usage, error).field("ask"));
        let answer = question.and_then(|question| self.answer_to(question, message));
        answer.unwrap_or_else(|error| Message::new(json(&Refusal { error })))
    }

    fn answer_to(&mut self, question: Question, message: &Message) -> Result<Message, PageError> {
        match question {
            Question::Names => Ok(Message::new(json(&Names::ALL))),
            Question::OpenMap(ask) => {
                let (opened, answer) = map::open(&ask, message)?;
                (self.map, self.layers) = (Some(opened), None);
                Ok(answer)
            }
            Question::EditMap(ask) => {
                let opened = self.map.as_mut().ok_or_else(Opened::none)?;
                let (edited, edits) = map::edit(&ask, opened);
                if let Some((.., layers)) = &mut self.layers {
                    layers.apply(&edits);
                }
                Ok(Message::new(json(&edited)))
            }
            Question::Plan(ask) => {
                let opened = self.map.as_ref().ok_or_else(Opened::none)?;
                route::plan(&ask, opened, &mut self.layers, &mut self.workspace)
            }
            Question::Search(ask) => {
                let opened = self.map.as_ref().ok_or_else(Opened::none)?;
                route::search(&ask, opened, &mut self.layers, &mut self.workspace)
            }
            Question::Drive(ask) => drive::drive(&ask, self.map.as_ref()),
        }
    }
}
