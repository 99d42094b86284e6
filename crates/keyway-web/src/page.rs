//! The state of a page, and its answers.

use crate::claims::{self, JudgeClaim, MeasureClaim, OpenClaim};
use crate::compare::{self, Compare, Summarise};
use crate::drive::{self, Drive};
use crate::error::{Kind, PageError};
use crate::map::{self, EditMap, OpenMap, Opened};
use crate::message::{Message, json};
use crate::names::Names;
use crate::route::{self, Layers, Plan};
use crate::scene::{self, BarnScenes, OpenScene};
use crate::search;
use keyway::search::Workspace;
use serde::{Deserialize, Serialize};

/// The state of a page: everything that it has open.
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
    OpenScene(OpenScene),
    BarnScenes(BarnScenes),
    Drive(Drive),
    Compare(Compare),
    Summary(Summarise),
    Claims,
    OpenClaim(OpenClaim),
    MeasureClaim(MeasureClaim),
    JudgeClaim(JudgeClaim),
}

/// The head of an error answer.
#[derive(Serialize)]
struct Refusal {
    error: PageError,
}

impl Page {
    /// Answers a question. An error is an answer, too, and does not change the state.
    pub fn answer(&mut self, message: &Message) -> Message {
        let question = serde_json::from_str(&message.head)
            .map_err(|error| PageError::new(Kind::Usage, error).field("ask"));
        let answer = question.and_then(|question| self.answer_to(question, message));
        answer.unwrap_or_else(|error| Message::new(json(&Refusal { error })))
    }

    fn answer_to(&mut self, question: Question, message: &Message) -> Result<Message, PageError> {
        match question {
            Question::Names => Ok(Message::new(json(&Names::ALL))),
            Question::OpenMap(ask) => Ok(self.open(map::open(&ask, message)?)),
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
                search::search(&ask, opened, &mut self.layers, &mut self.workspace)
            }
            Question::OpenScene(ask) => Ok(self.open(scene::open_scene(&ask, message)?)),
            Question::BarnScenes(ask) => scene::barn_scenes(&ask, message),
            Question::Drive(ask) => drive::drive(&ask, self.map.as_ref()),
            Question::Compare(ask) => {
                compare::compare(&ask, self.map.as_ref().ok_or_else(Opened::none)?)
            }
            Question::Summary(ask) => Ok(compare::summarise(ask)),
            Question::Claims => Ok(claims::claims()),
            Question::OpenClaim(ask) => Ok(self.open(claims::open_claim(&ask)?)),
            Question::MeasureClaim(ask) => claims::measure_claim(&ask),
            Question::JudgeClaim(ask) => claims::judge_claim(ask),
        }
    }

    /// Replaces the map.
    fn open(&mut self, (opened, answer): (Opened, Message)) -> Message {
        (self.map, self.layers) = (Some(opened), None);
        answer
    }
}
