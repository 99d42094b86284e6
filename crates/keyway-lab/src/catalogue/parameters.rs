//! Parameters of a config, from its values and from its schema, which contains the doc comments.

use serde::Serialize;
use serde_json::Value;

/// A parameter of a part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Path in a stack such as `planner.corners`; for a robot, its path in a robot file.
    pub path: String,
    /// Unit; `None` for a number, a text or a switch.
    pub unit: Option<&'static str>,
    /// Default value.
    pub default: Value,
    /// Published value; `None` if the paper has none.
    pub paper: Option<Value>,
    /// Possible values; `None` for a number, a text or a switch.
    pub choices: Option<Vec<String>>,
    /// Description for display.
    pub description: String,
}

impl Parameter {
    /// Returns the description, with the possible values if it names none.
    pub fn description_with_choices(&self) -> String {
        match &self.choices {
            Some(choices) if !self.description.contains('`') => {
                format!("{} {}", self.description, choices.join(" | "))
            }
            _ => self.description.clone(),
        }
    }
}

/// Suffixes of names and the units that they stand for, longer ones first.
const UNITS: [(&str, &str); 9] = [
    ("_radps2", "rad/s2"),
    ("_radps", "rad/s"),
    ("_mps2", "m/s2"),
    ("_mps", "m/s"),
    ("_cells", "cells"),
    ("_rad", "rad"),
    ("_deg", "deg"),
    ("_m", "m"),
    ("_s", "s"),
];

/// Returns all parameters in `config`, whose schema is the `root` of a document.
pub(super) fn parameters(
    path: &str,
    root: &Value,
    config: &Value,
    paper: &Value,
) -> Vec<Parameter> {
    let mut found = Vec::new();
    walk(&Node { root, schema: root }, path, config, paper, &mut found);
    found
}

/// Returns the description of the alternative of this name.
pub(super) fn summary_of(root: &Value, name: &str) -> String {
    let node = Node { root, schema: root }.alternative(name);
    plain(node.schema["description"].as_str().unwrap_or_default())
}

/// Converts a doc comment, which is Markdown with links into the code, to plain text for display.
pub(crate) fn plain(doc: &str) -> String {
    let text = doc.replace('\n', " ").replace("[`Self::", "`").replace("[`", "`");
    let text = text.replace("`]", "`").replace("\\[", "[").replace("\\]", "]");
    text.replace('²', "2")
}

/// A node of a schema document.
#[derive(Clone, Copy)]
struct Node<'a> {
    root: &'a Value,
    schema: &'a Value,
}

impl Node<'_> {
    /// Returns the node that a `$ref` refers to, or the node itself; for an optional value, the
    /// node of a present one.
    fn resolved(self) -> Self {
        let mut present = self.schema["anyOf"].as_array().into_iter().flatten();
        let reference = present.find(|one| !one["$ref"].is_null()).unwrap_or(self.schema);
        let target = reference["$ref"].as_str().and_then(|r| r.strip_prefix('#'));
        let schema = target.and_then(|pointer| self.root.pointer(pointer)).unwrap_or(self.schema);
        Self { schema, ..self }
    }

    /// Returns the alternative that a value selects: by its name, or by its only field.
    fn taken_by(self, value: &Value) -> Self {
        if let Some(name) = value["name"].as_str() {
            return self.alternative(name);
        }
        let field = value.as_object().and_then(|fields| fields.keys().next());
        let has_field = |one: &&Value| field.is_some_and(|f| one["properties"].get(f).is_some());
        let mut all = self.schema["oneOf"].as_array().into_iter().flatten();
        Self { schema: all.find(has_field).unwrap_or(self.schema), ..self }
    }

    /// Returns the alternative of this name.
    fn alternative(self, name: &str) -> Self {
        let all = self.schema["oneOf"].as_array().into_iter().flatten();
        let mut named = all.filter(|one| one["properties"]["name"]["const"] == name);
        Self { schema: named.next().unwrap_or(self.schema), ..self }
    }

    fn property(self, key: &str) -> Self {
        Self { schema: &self.schema["properties"][key], ..self }
    }

    /// Returns the node of a list item.
    fn item(self) -> Self {
        Self { schema: &self.resolved().schema["items"], ..self }
    }

    fn choices(self) -> Option<Vec<String>> {
        let schema = self.resolved().schema;
        let listed = schema["enum"].as_array().into_iter().flatten();
        let consts = schema["oneOf"].as_array().into_iter().flatten().map(|one| &one["const"]);
        let names = listed.chain(consts).filter_map(Value::as_str).map(str::to_owned);
        let names: Vec<String> = names.collect();
        (!names.is_empty()).then_some(names)
    }
}

fn walk(node: &Node<'_>, path: &str, config: &Value, paper: &Value, found: &mut Vec<Parameter>) {
    let all = node.resolved();
    let node = all.taken_by(config);
    // An alternative that is a single field is described as a whole.
    let is_field = config["name"].is_null() && !std::ptr::eq(node.schema, all.schema);
    for (key, value) in config.as_object().into_iter().flatten() {
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        let property = node.property(key);
        if value.is_object() {
            walk(&property, &path, value, &paper[key], found);
            continue;
        }
        // For an array of tables, the fields of the first one.
        if let Some(first) = value.get(0).filter(|first| first.is_object()) {
            walk(&property.item(), &path, first, &paper[key], found);
            continue;
        }
        // The name of an alternative is a parameter of the whole, not of the alternative.
        if key == "name" {
            continue;
        }
        let described = if is_field { node } else { property };
        let description = described.schema["description"].as_str().unwrap_or_default();
        found.push(Parameter {
            unit: UNITS.iter().find(|(suffix, _)| key.ends_with(suffix)).map(|(_, unit)| *unit),
            default: value.clone(),
            paper: paper.get(key).cloned(),
            choices: property.choices(),
            description: plain(description),
            path,
        });
    }
}

/// Text of a value, with enough digits for display.
pub fn value_text(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or_default();
            format!("{}", (number * 1e6).round() / 1e6)
        }
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::navigate::Stack;
    use keyway::plan::PlannerConfig;
    use keyway::robot::Robot;
    use schemars::schema_for;

    #[test]
    fn every_parameter_is_described() {
        let planner = PlannerConfig::by_name("astar").unwrap();
        let stack = Stack { planner, ..Stack::key_point_fusion(&Robot::small()) };
        let config = serde_json::to_value(stack).unwrap();
        let stack = parameters("", &schema_for!(Stack).to_value(), &config, &Value::Null);
        let robot = serde_json::to_value(Robot::small()).unwrap();
        let robot = parameters("", &schema_for!(Robot).to_value(), &robot, &Value::Null);
        assert!(stack.len() > 20 && robot.len() > 10);
        for parameter in stack.iter().chain(&robot) {
            assert!(!parameter.description.is_empty(), "{}", parameter.path);
            assert!(!parameter.description.contains(['\n', '\\']), "{}", parameter.description);
        }
        let corners = stack.iter().find(|p| p.path == "planner.corners").unwrap();
        assert_eq!(corners.choices.as_deref().unwrap(), ["forbid", "allow"]);
        let speed = robot.iter().find(|p| p.path == "limits.v_max_mps").unwrap();
        assert_eq!((speed.unit, &speed.default), (Some("m/s"), &Value::from(0.5)));
        let range = robot.iter().find(|p| p.path == "sensors.range_m").unwrap();
        assert_eq!((range.unit, &range.default), (Some("m"), &Value::from(3.5)));
    }
}
