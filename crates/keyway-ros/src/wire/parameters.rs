//! Parameters, as other nodes read and set them.

use crate::settings::Change;
use ros2_client::NodeOptions;
use ros2_client::parameters::ParameterValue;
use std::sync::mpsc::{Receiver, channel};
use toml::Value;

/// The options of a node with these parameters, and the channel of their changes.
pub(super) fn with_parameters(declared: &[(&str, Value)]) -> (NodeOptions, Receiver<Change>) {
    let (changes, changed) = channel();
    let mut options = NodeOptions::new().enable_rosout(true);
    for (name, value) in declared {
        options = options.declare_parameter(name, sent(value));
    }
    // Values are also checked and set at the start.
    let first: Vec<(String, Value)> =
        declared.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    let is_first = move |name: &str, value: &Value| {
        first.iter().any(|(declared, given)| declared == name && given == value)
    };
    let options = options
        .parameter_validator(Box::new(move |name, value| {
            let value = received(value);
            if is_first(name, &value) { Ok(()) } else { Change::of(name, &value).map(drop) }
        }))
        .parameter_set_action(Box::new(move |name, value| {
            if let Ok(change) = Change::of(name, &received(value)) {
                // During shutdown, nobody receives it.
                drop(changes.send(change));
            }
            Ok(())
        }));
    (options, changed)
}

fn sent(value: &Value) -> ParameterValue {
    match value {
        Value::Boolean(truth) => ParameterValue::Boolean(*truth),
        Value::Integer(whole) => ParameterValue::Integer(*whole),
        Value::Float(number) => ParameterValue::Double(*number),
        Value::String(text) => ParameterValue::String(text.clone()),
        Value::Array(texts) => {
            let text = |value: &Value| Some(value.as_str()?.to_owned());
            ParameterValue::StringArray(texts.iter().filter_map(text).collect())
        }
        Value::Datetime(_) | Value::Table(_) => ParameterValue::NotSet,
    }
}

fn received(value: &ParameterValue) -> Value {
    match value {
        ParameterValue::Boolean(truth) => Value::Boolean(*truth),
        ParameterValue::Integer(whole) => Value::Integer(*whole),
        ParameterValue::Double(number) => Value::Float(*number),
        ParameterValue::String(text) => Value::String(text.clone()),
        ParameterValue::StringArray(texts) => {
            Value::Array(texts.iter().cloned().map(Value::String).collect())
        }
        // No parameter has a value of this type.
        _ => Value::Array(Vec::new()),
    }
}
