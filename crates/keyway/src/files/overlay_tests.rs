use super::*;
use serde::Deserialize;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct House {
    rooms: u32,
    heating: Heating,
    garden: Garden,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Heating {
    Stove { wood_kg: f64 },
    HeatPump { power_w: f64, mode: Mode },
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Mode {
    Day,
    Night,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Garden {
    pond: bool,
    length_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    fence: Option<Fence>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fence {
    height_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gate_m: Option<f64>,
}

fn house() -> House {
    let garden = Garden { pond: false, length_m: 8.0, fence: None };
    House { rooms: 3, heating: Heating::Stove { wood_kg: 5.0 }, garden }
}

fn named(path: &str, name: &str) -> Result<Table, Vec<&'static str>> {
    assert_eq!(path, "heating");
    match name {
        "stove" => Ok(Table::try_from(Heating::Stove { wood_kg: 1.0 }).unwrap()),
        "heat-pump" => {
            Ok(Table::try_from(Heating::HeatPump { power_w: 900.0, mode: Mode::Day }).unwrap())
        }
        _ => Err(vec!["stove", "heat-pump"]),
    }
}

fn changed(changes: &[&str]) -> Result<House, OverlayError> {
    let mut overlay = Overlay::of(&house(), &named)?;
    for change in changes {
        let (path, text) = change.split_once('=').unwrap();
        overlay.set(path, value_from_text(text))?;
    }
    overlay.finish()
}

fn error(change: &str) -> String {
    changed(&[change]).unwrap_err().to_string()
}

#[test]
fn fields_change_one_by_one() {
    let new = changed(&["rooms=4", "garden.pond=true", "garden.length_m=12"]).unwrap();
    assert_eq!((new.rooms, new.garden), (4, Garden { pond: true, length_m: 12.0, fence: None }));
    assert_eq!(new.heating, house().heating);
    let table = changed(&["garden={ pond = true }"]).unwrap();
    assert_eq!(table.garden, Garden { pond: true, length_m: 8.0, fence: None });
}

#[test]
fn what_has_no_value_can_be_given_one() {
    let fenced = changed(&["garden.fence={ height_m = 1.5 }", "garden.fence.gate_m=2"]).unwrap();
    assert_eq!(fenced.garden.fence, Some(Fence { height_m: 1.5, gate_m: Some(2.0) }));
    let text = error("garden.fence={ height_m = \"low\" }");
    assert!(text.starts_with("`garden.fence`: ") && text.contains("low"), "{text}");
    let text = error("garden.fence={ width_m = 1.0 }");
    assert!(text.starts_with("`garden.fence`") || text.contains("no field"), "{text}");
    // Field by field, once no required field is missing.
    let fenced = changed(&["garden.fence.height_m=1.0", "garden.fence.gate_m=2"]).unwrap();
    assert_eq!(fenced.garden.fence, Some(Fence { height_m: 1.0, gate_m: Some(2.0) }));
    let text = error("garden.fence.gate_m=2");
    assert!(text.starts_with("`garden.fence`: ") && text.contains("height_m"), "{text}");
    let text = error("garden.hedge.height_m=1.0");
    assert_eq!(text, "there is no field `garden.hedge`; `garden` has: pond, length_m");
}

#[test]
fn a_new_name_starts_from_its_default() {
    let pump = Heating::HeatPump { power_w: 900.0, mode: Mode::Day };
    assert_eq!(changed(&["heating.name=heat-pump"]).unwrap().heating, pump);
    let kept = changed(&["heating.wood_kg=7", "heating.name=stove"]).unwrap();
    assert_eq!(kept.heating, Heating::Stove { wood_kg: 7.0 });
}

#[test]
fn a_tree_is_merged_names_first() {
    let text = "rooms = 5\n[heating]\nmode = \"night\"\nname = \"heat-pump\"\n";
    let mut overlay = Overlay::of(&house(), &named).unwrap();
    overlay.merge(&text.parse().unwrap()).unwrap();
    let new = overlay.finish().unwrap();
    assert_eq!((new.rooms, &new.garden), (5, &house().garden));
    assert_eq!(new.heating, Heating::HeatPump { power_w: 900.0, mode: Mode::Night });
}

#[test]
fn errors_name_the_field_and_what_is_right() {
    assert_eq!(
        error("room=1"),
        "there is no field `room`; the fields are: rooms, heating, garden; did you mean `rooms`?"
    );
    assert_eq!(
        error("garden.size=1"),
        "there is no field `garden.size`; `garden` has: pond, length_m"
    );
    assert_eq!(
        error("cellar.size=1"),
        "there is no field `cellar`; the fields are: rooms, heating, garden"
    );
    assert_eq!(error("garden.pond.fish=1"), "`garden.pond`: has no fields of its own");
    assert_eq!(
        error("garden.pond=wet"),
        "`garden.pond`: invalid type: string \"wet\", expected a boolean"
    );
    let expected = "expected a whole number from 0 to 4294967295";
    let kind = "`rooms`: invalid type: floating point `2.5`, ";
    assert_eq!(error("rooms=2.5"), format!("{kind}{expected}"));
    assert_eq!(error("garden=1"), "`garden`: invalid type: integer `1`, expected a table");
    assert_eq!(
        error("heating.name=sun"),
        "`heating.name` must be one of stove, heat-pump, got `sun`"
    );
    let value = "`rooms`: invalid value: integer `-1`, ";
    assert_eq!(error("rooms=-1"), format!("{value}{expected}"));
    let mode = changed(&["heating.name=heat-pump", "heating.mode=dusk"]).unwrap_err();
    assert_eq!(mode.path(), "heating.mode");
    let expected = "`heating.mode`: unknown value `dusk`, expected `day` or `night`";
    assert_eq!(mode.to_string(), expected);
}

#[test]
fn texts_are_values_where_they_can_be() {
    assert_eq!(value_from_text("1"), Value::Integer(1));
    assert_eq!(value_from_text("1e-3"), Value::Float(1e-3));
    assert_eq!(value_from_text("\"1\""), Value::String("1".to_owned()));
    assert_eq!(value_from_text("line-of-sight"), Value::String("line-of-sight".to_owned()));
    assert_eq!(value_from_text("1\nmore = 2"), Value::String("1\nmore = 2".to_owned()));
    assert_eq!(value_from_text(""), Value::String(String::new()));
}
