//! Suggestions for misspelt names.

/// A suggestion to end an error message with that refuses a name: `; did you mean ...?` with the
/// nearest of the existing names. Empty if none is near. Case is ignored.
///
/// ```
/// use keyway::files::did_you_mean;
/// assert_eq!(did_you_mean("Jakcal", ["small", "jackal"]), "; did you mean `jackal`?");
/// assert_eq!(did_you_mean("hal", ["small", "jackal"]), "");
/// ```
pub fn did_you_mean<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let given = given.to_lowercase();
    // A third of the letters may be wrong.
    let most = given.chars().count() / 3;
    let distance = |name: &str| strsim::osa_distance(&given, &name.to_lowercase());
    let near = names.into_iter().map(|name| (distance(name), name));
    let nearest = near.filter(|(wrong, _)| *wrong <= most).min_by_key(|(wrong, _)| *wrong);
    nearest.map_or_else(String::new, |(_, name)| format!("; did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_meant_if_it_is_near() {
        let names = ["jps", "astar", "astar4", "theta-star", "lazy-theta-star"];
        let meant = |given: &str| did_you_mean(given, names);
        assert_eq!(meant("jsp"), "; did you mean `jps`?");
        assert_eq!(meant("astar5"), "; did you mean `astar`?", "of equals the first");
        assert_eq!(meant("THETA_STAR"), "; did you mean `theta-star`?");
        assert_eq!(["", "a", "rrt", "dijkstra"].map(meant), [""; 4]);
        assert_eq!(did_you_mean("jps", []), "");
    }
}
