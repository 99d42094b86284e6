//! Argument values with a syntax of their own.

use keyway::ConfigError;
use keyway::geometry::{Disc, Point};
use keyway::map::GridFrame;
use keyway_lab::batch::Shard;
use keyway_sim::sim::{MovingObstacle, ObstacleMotion, WayPoints};
use std::path::PathBuf;
use std::str::FromStr;

/// `X,Y`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PositionArg(pub(crate) Point);

/// `X,Y` or `X,Y,YAW_DEG`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PoseArg {
    pub(crate) x: f64,
    pub(crate) y: f64,
    pub(crate) yaw_deg: Option<f64>,
}

/// `X,Y,RADIUS`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiscArg(pub(crate) Disc);

/// `X,Y,RADIUS,VX,VY`, or `X,Y,RADIUS,SPEED:X,Y` with as many further points as needed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MovingArg {
    radius_m: f64,
    /// The first is the position at the start.
    points: Vec<Point>,
    pace: Pace,
}

/// Motion of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace {
    /// Constant velocity \[m/s\].
    Velocity(Point),
    /// A closed loop from point to point, at a speed \[m/s\].
    Round(f64),
}

/// Output file of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PictureFile {
    pub(crate) path: PathBuf,
    pub(crate) is_png: bool,
}

/// Output file of an animation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct AnimationFile {
    pub(crate) path: PathBuf,
    pub(crate) format: AnimationFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AnimationFormat {
    Gif,
    Apng,
}

/// Output file of a sampled path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct CurveFile {
    pub(crate) path: PathBuf,
    pub(crate) format: CurveFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CurveFormat {
    Csv,
    Json,
}

impl FromStr for PositionArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text, "X,Y")?[..] {
            [x, y] => Ok(Self(Point::new(x, y))),
            _ => Err("expected two numbers X,Y".to_owned()),
        }
    }
}

impl FromStr for PoseArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text, "X,Y or X,Y,YAW_DEG")?[..] {
            [x, y] => Ok(Self { x, y, yaw_deg: None }),
            [x, y, yaw] => Ok(Self { x, y, yaw_deg: Some(yaw) }),
            _ => Err("expected two or three numbers X,Y[,YAW_DEG]".to_owned()),
        }
    }
}

impl FromStr for DiscArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text, "X,Y,RADIUS")?[..] {
            [x, y, radius_m] if radius_m >= 0.0 => Ok(Self(Disc::new(Point::new(x, y), radius_m))),
            [_, _, radius_m] => Err(format!("the radius must be at least 0, got {radius_m:?}")),
            _ => Err("expected three numbers X,Y,RADIUS".to_owned()),
        }
    }
}

impl MovingArg {
    const FORMS: &str = "X,Y,RADIUS,VX,VY or X,Y,RADIUS,SPEED:X,Y[:X,Y...]";

    /// The points as given.
    pub(crate) fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns the obstacle. `points` are its points in the world frame, one for each given
    /// point.
    pub(crate) fn mover(&self, points: Vec<Point>) -> Result<MovingObstacle, ConfigError> {
        let motion = match (self.pace, &points[..]) {
            (Pace::Velocity(velocity_mps), &[from, ..]) => {
                ObstacleMotion::Straight { from, velocity_mps }
            }
            (Pace::Velocity(_), []) => return Err(ConfigError::new("position", "is missing")),
            (Pace::Round(speed_mps), _) => {
                ObstacleMotion::WayPoints(WayPoints::around(points, speed_mps)?)
            }
        };
        MovingObstacle::new(self.radius_m, motion)
    }
}

impl FromStr for MovingArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.split(':');
        let first = numbers(parts.next().unwrap_or_default(), Self::FORMS)?;
        let others = parts.map(|part| match numbers(part, Self::FORMS)?[..] {
            [x, y] => Ok(Point::new(x, y)),
            _ => Err(format!("expected {}", Self::FORMS)),
        });
        let others = others.collect::<Result<Vec<Point>, String>>()?;
        let (x, y, radius_m, pace) = match (&first[..], others.is_empty()) {
            (&[x, y, radius_m, vx, vy], true) => {
                (x, y, radius_m, Pace::Velocity(Point::new(vx, vy)))
            }
            (&[x, y, radius_m, speed_mps], false) => (x, y, radius_m, Pace::Round(speed_mps)),
            _ => return Err(format!("expected {}", Self::FORMS)),
        };
        let mut points = vec![Point::new(x, y)];
        points.extend(others);
        let moving = Self { radius_m, points, pace };
        // Check now, so that an error blames this argument.
        moving.mover(moving.points.clone()).map_err(|error| error.to_string())?;
        Ok(moving)
    }
}

impl FromStr for PictureFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, is_png) = by_extension(text, [("svg", false), ("png", true)])?;
        Ok(Self { path, is_png })
    }
}

impl FromStr for AnimationFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let formats = [("gif", AnimationFormat::Gif), ("apng", AnimationFormat::Apng)];
        by_extension(text, formats).map(|(path, format)| Self { path, format })
    }
}

impl FromStr for CurveFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let formats = [("csv", CurveFormat::Csv), ("json", CurveFormat::Json)];
        by_extension(text, formats).map(|(path, format)| Self { path, format })
    }
}

/// `I/N`: the I-th of N parts.
pub(super) fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    numbers.and_then(|(number, of)| Shard::new(number, of).ok()).ok_or_else(|| {
        let most = Shard::MOST;
        format!("expected I/N, such as 1/4: the first of four parts, of at most {most}")
    })
}

/// A length greater than 0.
pub(super) fn positive_length(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(length) if length > 0.0 && f64::is_finite(length) => Ok(length),
        _ => Err("expected a positive number of metres".to_owned()),
    }
}

/// A time of a run.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(time) if time >= 0.0 && f64::is_finite(time) => Ok(time),
        _ => Err("expected a number of seconds of at least 0".to_owned()),
    }
}

/// The side length of a cell.
pub(super) fn resolution(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(side) if GridFrame::RESOLUTIONS_M.contains(&side) => Ok(side),
        _ => Err("expected metres per cell, from 1e-6 to 1e6".to_owned()),
    }
}

/// The radius of a robot, or 0.
pub(super) fn radius(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(radius) if radius >= 0.0 && f64::is_finite(radius) => Ok(radius),
        _ => Err("expected a length of at least 0 in metres".to_owned()),
    }
}

/// An integer in a range.
pub(super) fn whole<T: TryFrom<u64>, const LEAST: u64, const MOST: u64>(
    text: &str,
) -> Result<T, String> {
    let number = text.parse().ok().filter(|number| (LEAST..=MOST).contains(number));
    number.and_then(|number| T::try_from(number).ok()).ok_or_else(|| match MOST {
        u64::MAX => format!("expected a whole number of at least {LEAST}"),
        _ => format!("expected a whole number from {LEAST} to {MOST}"),
    })
}

/// A file, and the format of its extension, in upper or lower case.
fn by_extension<T: Copy>(text: &str, formats: [(&str, T); 2]) -> Result<(PathBuf, T), String> {
    let path = PathBuf::from(text);
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let format = formats.iter().find(|(name, _)| extension.eq_ignore_ascii_case(name));
    let Some(&(_, format)) = format else {
        let [(one, _), (other, _)] = formats;
        return Err(format!("expected a file name that ends in .{one} or .{other}"));
    };
    Ok((path, format))
}

/// Largest coordinate \[m\]: no map extends this far, and numbers up to it fit on a line.
const FARTHEST: f64 = 1e12;

fn numbers(text: &str, expected: &str) -> Result<Vec<f64>, String> {
    text.split(',')
        .map(|part| match part.trim().parse::<f64>() {
            Ok(number) if number.abs() <= FARTHEST => Ok(number),
            Ok(number) if number.is_finite() => Err(format!(
                "`{}` is farther than any map reaches, expected {expected}",
                part.trim()
            )),
            _ => Err(format!("`{}` is not a number, expected {expected}", part.trim())),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions() {
        assert_eq!("-1.5,2".parse(), Ok(PositionArg(Point::new(-1.5, 2.0))));
        assert_eq!("1, 2, -90".parse(), Ok(PoseArg { x: 1.0, y: 2.0, yaw_deg: Some(-90.0) }));
        for bad in ["", "1", "1,2,3,4", "1,x", "nan,1", "1,,2", "inf,0"] {
            assert!(bad.parse::<PositionArg>().is_err() && bad.parse::<PoseArg>().is_err());
        }
        let error = "1,abc".parse::<PositionArg>().unwrap_err();
        assert_eq!(error, "`abc` is not a number, expected X,Y");
        assert!("1,2,-0.1".parse::<DiscArg>().is_err());
    }

    #[test]
    fn moving_obstacles() {
        let mover = |text: &str| {
            let moving: MovingArg = text.parse()?;
            moving.mover(moving.points().to_vec()).map_err(|error| error.to_string())
        };
        let straight = mover("1,2,0.25,-0.5,0").unwrap();
        assert_eq!((straight.radius_m(), straight.at(2.0).centre), (0.25, Point::new(0.0, 2.0)));
        let round = mover("1,2,0.25,0.5:3,2:3,4").unwrap();
        assert_eq!(
            [round.at(0.0), round.at(6.0)].map(|c| c.centre),
            [[1.0, 2.0], [3.0, 3.0]].map(Point::from)
        );
        for bad in [
            "1,2,0.25",
            "1,2,0.25,1",
            "1,2,0.25,1,2,3",
            "1,2,0.25,1,2:3,4",
            "1,2,0.25,1:",
            "1,2,0.25,1:3",
        ] {
            let error = mover(bad).unwrap_err();
            assert!(error.contains("X,Y,RADIUS,VX,VY or X,Y,RADIUS,SPEED:X,Y"), "{error}");
        }
        assert_eq!(
            mover("1,2,-1,0,0").unwrap_err(),
            "radius_m must be a number of at least 0, got -1"
        );
        assert!(
            mover("1,2,1,0:3,3").unwrap_err().starts_with("speed_mps must be a positive number")
        );
        assert!(mover("1,2,1,1:1,2").unwrap_err().contains("two different points"));
    }

    #[test]
    fn pictures_and_other_files() {
        assert!("a.PNG".parse::<PictureFile>().unwrap().is_png);
        let gif: AnimationFile = "a.Gif".parse().unwrap();
        assert_eq!(gif.format, AnimationFormat::Gif);
        assert_eq!("a.b.apng".parse::<AnimationFile>().unwrap().format, AnimationFormat::Apng);
        assert!(
            "a.png".parse::<AnimationFile>().is_err() && "gif".parse::<AnimationFile>().is_err()
        );
        assert!("a.jpg".parse::<PictureFile>().is_err() && "svg".parse::<PictureFile>().is_err());
        assert_eq!("a.CSV".parse::<CurveFile>().unwrap().format, CurveFormat::Csv);
        assert_eq!("a.json".parse::<CurveFile>().unwrap().format, CurveFormat::Json);
        assert!("a.txt".parse::<CurveFile>().is_err() && "csv".parse::<CurveFile>().is_err());
    }
}
