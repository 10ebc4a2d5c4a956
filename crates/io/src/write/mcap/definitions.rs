//! The definitions of the messages that are written, in the interface language of ROS 2.

/// A type and all that it is made of, the type first.
pub(super) struct Definition {
    pub(super) name: &'static str,
    pub(super) text: &'static str,
    /// Types that it needs, with their own.
    pub(super) needs: &'static [(&'static str, &'static str)],
}

impl Definition {
    /// All definitions in one text, parted as recorders of ROS 2 part them.
    pub(super) fn whole(&self) -> String {
        let mut text = self.text.to_owned();
        for (name, definition) in self.needs {
            let line = "=".repeat(80);
            text.push_str(&format!("{line}\nMSG: {name}\n{definition}"));
        }
        text
    }
}

pub(super) const NAV_SAT_FIX: Definition = Definition {
    name: "sensor_msgs/msg/NavSatFix",
    text: "\
std_msgs/Header header
sensor_msgs/NavSatStatus status
float64 latitude
float64 longitude
float64 altitude
float64[9] position_covariance
uint8 COVARIANCE_TYPE_UNKNOWN = 0
uint8 COVARIANCE_TYPE_APPROXIMATED = 1
uint8 COVARIANCE_TYPE_DIAGONAL_KNOWN = 2
uint8 COVARIANCE_TYPE_KNOWN = 3
uint8 position_covariance_type
",
    needs: &[("sensor_msgs/NavSatStatus", STATUS), HEADER, TIME],
};

pub(super) const ODOMETRY: Definition = Definition {
    name: "nav_msgs/msg/Odometry",
    text: "\
std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
",
    needs: &[
        (
            "geometry_msgs/PoseWithCovariance",
            "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
        ),
        (
            "geometry_msgs/TwistWithCovariance",
            "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
        ),
        (
            "geometry_msgs/Pose",
            "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
        ),
        (
            "geometry_msgs/Twist",
            "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
        ),
        ("geometry_msgs/Point", XYZ),
        QUATERNION,
        ("geometry_msgs/Vector3", XYZ),
        HEADER,
        TIME,
    ],
};

pub(super) const IMU: Definition = Definition {
    name: "sensor_msgs/msg/Imu",
    text: "\
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
",
    needs: &[QUATERNION, ("geometry_msgs/Vector3", XYZ), HEADER, TIME],
};

const HEADER: (&str, &str) = (
    "std_msgs/Header",
    "builtin_interfaces/Time stamp\nstring frame_id\n",
);

const TIME: (&str, &str) = ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");

const QUATERNION: (&str, &str) = (
    "geometry_msgs/Quaternion",
    "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
);

const XYZ: &str = "float64 x\nfloat64 y\nfloat64 z\n";

const STATUS: &str = "\
int8 STATUS_NO_FIX = -1
int8 STATUS_FIX = 0
int8 STATUS_SBAS_FIX = 1
int8 STATUS_GBAS_FIX = 2
int8 status
uint16 SERVICE_GPS = 1
uint16 SERVICE_GLONASS = 2
uint16 SERVICE_COMPASS = 4
uint16 SERVICE_GALILEO = 8
uint16 service
";
