//! Checks of a request for a comparison.

use super::Comparison;
use super::choice::{Choice, refuse_repeated};
use super::columns::ChosenColumns;
use super::map_names::MapNames;
use super::request::CompareRequest;
use super::request_error::CompareRequestError;

impl CompareRequest {
    /// Checks the whole request before anything is planned.
    ///
    /// # Errors
    /// Returns [`CompareRequestError`] for the first field that cannot be used, with its value.
    pub fn check(self) -> Result<Comparison, CompareRequestError> {
        self.check_numbers()?;
        let choice = Choice::of(&self)?;
        refuse_repeated("columns", &self.columns)?;
        let columns = ChosenColumns::new(&self.columns, self.has_times)
            .map_err(CompareRequestError::Columns)?;
        Ok(Comparison {
            names: MapNames::new(&self.maps)?,
            choice,
            queries: self.queries,
            repeat: self.repeat,
            has_times: self.has_times,
            columns,
            why: self.why,
        })
    }

    fn check_numbers(&self) -> Result<(), CompareRequestError> {
        let counts = [
            ("queries", self.queries.count().map(|count| count as u64), Self::MOST_QUERIES as u64),
            ("repeat", Some(self.repeat), Self::MOST_REPEATS),
        ];
        for (field, count, most) in counts {
            if let Some(got) = count.filter(|count| !(1..=most).contains(count)) {
                return Err(CompareRequestError::Count { field, least: 1, most, got });
            }
        }
        match self.radius_m.filter(|radius_m| !(radius_m.is_finite() && *radius_m >= 0.0)) {
            Some(radius_m) => Err(CompareRequestError::Radius { radius_m }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::QueryChoice;
    use keyway::files::{Assignment, FieldValue, ParameterFile};
    use keyway::plan::PlannerConfig;
    use keyway::smooth::SmootherConfig;

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|&name| name.to_owned()).collect()
    }

    fn assignments(all: &[&str]) -> Vec<Assignment> {
        all.iter().map(|text| text.parse().unwrap()).collect()
    }

    fn request(change: impl FnOnce(&mut CompareRequest)) -> CompareRequest {
        let mut request = CompareRequest::new(vec!["a.map".into()]);
        change(&mut request);
        request
    }

    #[test]
    fn what_is_compared_without_names() {
        let compared = |change: &dyn Fn(&mut CompareRequest)| {
            let choice = request(change).check().unwrap().choice;
            let planners = choice.planners.iter().map(PlannerConfig::name);
            planners
                .chain(choice.smoothers.iter().map(SmootherConfig::name))
                .collect::<Vec<_>>()
                .join(" ")
        };
        assert_eq!(compared(&|_| ()), "jps theta-star none taut continuous-curvature");
        assert_eq!(compared(&|it| it.planners = names(&["astar"])), "astar none");
        assert_eq!(compared(&|it| it.smoothers = names(&["taut"])), "jps taut");
        let with_file = compared(&|it| {
            let table = "planner.name = \"dijkstra\"".parse().unwrap();
            it.parameters.file = Some(ParameterFile { name: "a.toml".to_owned(), table });
        });
        assert_eq!(with_file, "dijkstra none");
        assert!(
            request(|it| it.planners = names(&["all"])).check().unwrap().choice.leaves_out_unfit
        );
    }

    #[test]
    fn errors_name_the_field() {
        let set = |it: &mut CompareRequest, text: &str| {
            it.parameters.assignments = assignments(&[text]);
        };
        for (request, field, message) in [
            (
                request(|it| it.planners = names(&["jps", "jps"])),
                "planners",
                "planners: jps is given twice",
            ),
            (
                request(|it| it.smoothers = names(&["none", "all"])),
                "smoothers",
                "smoothers: `all` stands for all names; give it alone",
            ),
            (
                request(|it| it.columns = names(&["solved", ""])),
                "columns",
                "columns: a name is missing in `solved,`",
            ),
            (
                request(|it| it.planners = names(&["jsp"])),
                "planners",
                "planners: `planner.name` must be one of ",
            ),
            (
                request(|it| it.queries = QueryChoice::Random { count: 0, seed: 0 }),
                "queries",
                "queries: expected a whole number from 1 to 1000000, got 0",
            ),
            (
                request(|it| it.repeat = 1001),
                "repeat",
                "repeat: expected a whole number from 1 to 1000, got 1001",
            ),
            (
                request(|it| it.radius_m = Some(f64::NAN)),
                "radius",
                "radius: expected a length of at least 0 in metres, got NaN",
            ),
            (request(|it| it.robot = Some("hal".to_owned())), "robot", "there is no robot `hal`"),
            (
                request(|it| set(it, "map.a=1")),
                "parameters",
                "parameters: there is no field `map.a`",
            ),
            (
                request(|it| set(it, "planner.name=astar")),
                "parameters",
                "parameters: `planner.name` cannot be set in a comparison; ",
            ),
            (
                request(|it| set(it, "hsta.l1_constraint=1")),
                "parameters",
                "hsta.l1_constraint: this part is not compared; the planners are jps, theta-star, ",
            ),
            (
                request(|it| {
                    it.parameters.fields = vec![FieldValue::new("unknown", "map.unknown", "no")];
                }),
                "unknown",
                "unknown: `map.unknown`: ",
            ),
            (
                request(|it| {
                    it.has_times = false;
                    it.columns = names(&["plan"]);
                }),
                "columns",
                "columns: plan is a time, but times are omitted",
            ),
        ] {
            let error = request.check().unwrap_err();
            assert!(error.to_string().starts_with(message), "{error}");
            assert_eq!(error.field(), field, "{error}");
        }
    }

    #[test]
    fn a_parameter_names_its_owner() {
        let request = request(|it| {
            it.planners = names(&["jps", "ratio-astar"]);
            it.parameters.assignments = assignments(&["ratio-astar.x=0"]);
        });
        let error = request.check().unwrap_err();
        assert!(error.to_string().starts_with("ratio-astar: planner.x must be"), "{error}");
        let CompareRequestError::Parameters { path, .. } = error else { panic!("{error:?}") };
        assert_eq!(path, "ratio-astar.x");
    }
}
