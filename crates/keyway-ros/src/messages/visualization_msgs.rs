//! `visualization_msgs`.

use super::Named;
use super::builtin_interfaces::Duration;
use super::geometry_msgs::{Pose, Vector3};
use super::sensor_msgs::CompressedImage;
use super::std_msgs::{ColorRgba, Header};
use serde::{Deserialize, Serialize};

/// A shape to draw.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Marker {
    pub(crate) header: Header,
    /// `ns` in the definition: the scope of the ids.
    pub(crate) namespace: String,
    pub(crate) id: i32,
    /// `type` in the definition.
    pub(crate) shape: i32,
    pub(crate) action: i32,
    pub(crate) pose: Pose,
    pub(crate) scale: Vector3,
    pub(crate) color: ColorRgba,
    /// Zero means unlimited.
    pub(crate) lifetime: Duration,
    pub(crate) frame_locked: bool,
    pub(crate) points: Vec<Vector3>,
    pub(crate) colors: Vec<ColorRgba>,
    pub(crate) texture_resource: String,
    pub(crate) texture: CompressedImage,
    pub(crate) uv_coordinates: Vec<UvCoordinate>,
    pub(crate) text: String,
    pub(crate) mesh_resource: String,
    pub(crate) mesh_file: MeshFile,
    pub(crate) mesh_use_embedded_materials: bool,
}

impl Marker {
    pub(crate) const ARROW: i32 = 0;
    pub(crate) const CYLINDER: i32 = 3;
    pub(crate) const LINE_STRIP: i32 = 4;
    /// A line from each point with an even index to the next one.
    pub(crate) const LINE_LIST: i32 = 5;

    /// The action that deletes all markers of the topic.
    pub(crate) const DELETE_ALL: i32 = 3;
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct UvCoordinate {
    pub(crate) u: f32,
    pub(crate) v: f32,
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct MeshFile {
    pub(crate) filename: String,
    pub(crate) data: Vec<u8>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct MarkerArray {
    pub(crate) markers: Vec<Marker>,
}

impl Named for MarkerArray {
    const NAME: (&'static str, &'static str) = ("visualization_msgs", "MarkerArray");
}
