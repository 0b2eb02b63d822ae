//! How recordings are laid out.

use serde::Serialize;
use strum::{EnumMessage, EnumString, IntoStaticStr, VariantArray};

/// How a recording is laid out.
///
/// - MRCLAM: time in s, x and y in m, heading in rad, between blanks; `#` begins a comment. A file per robot, named
///   `<robot>_Groundtruth.dat`
/// - Pioneer: a file per robot, named `<robot>_mocap_ground_pose.csv`
/// - CSV: these columns in any order among others, `robot` unless the file is one robot's, with comma, semicolon or tab between them
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Default,
    Serialize,
    EnumMessage,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum RecordingLayout {
    /// By header and extension
    #[default]
    Auto,
    /// Groundtruth files of UTIAS MRCLAM: time x y heading
    Mrclam,
    /// t_s,x_m,y_m,theta_rad
    PioneerMocap,
    /// time_s,robot,x_m,y_m,heading_rad
    Csv,
}
