//! Parts of ROS 2 message definitions, in the `ros2msg` format.

macro_rules! separator {
    () => {
        "\n================================================================================\nMSG: "
    };
}

macro_rules! header {
    () => {
        concat!(
            separator!(),
            "std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id",
            separator!(),
            "builtin_interfaces/Time\nint32 sec\nuint32 nanosec"
        )
    };
}

macro_rules! vector3 {
    () => {
        concat!(separator!(), "geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z")
    };
}

macro_rules! quaternion {
    () => {
        concat!(
            separator!(),
            "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w"
        )
    };
}

macro_rules! pose {
    () => {
        concat!(
            separator!(),
            "geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation",
            separator!(),
            "geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z",
            quaternion!()
        )
    };
}

macro_rules! twist {
    () => {
        concat!(
            separator!(),
            "geometry_msgs/Twist\ngeometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular",
            vector3!()
        )
    };
}

pub(super) use {header, pose, quaternion, separator, twist, vector3};
