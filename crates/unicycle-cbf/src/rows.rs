//! The rows of the quadratic program, each with what it stands for.

use serde::Serialize;
use strum::IntoStaticStr;

use crate::lie::Lie;
use crate::qp::{MAX_ROWS, Row};
use crate::unicycle::Affine;

/// What a row asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, IntoStaticStr)]
#[serde(into = "&'static str")]
#[strum(serialize_all = "kebab-case")]
pub enum RowKind {
    /// `V1`, the desired speed
    #[strum(to_string = "V1")]
    Speed,
    /// `V2`, no turning
    #[strum(to_string = "V2")]
    TurnRate,
    /// `V3`, the path
    #[strum(to_string = "V3")]
    Tracking,
    /// Distance to the robot ahead as it moves
    Headway,
    /// Distance to where the robot ahead was last seen
    HeadwayStopped,
    /// Distance between the bodies of two robots
    Apart,
    /// How fast the points of two robots of which one follows the other come nearer to each other
    Point,
    /// The way along the path to where a robot waits for one on another branch
    GiveWay,
    /// Both edges of the lane
    Lane,
    /// The edge at positive deviations
    LaneRight,
    /// The edge at negative deviations
    LaneLeft,
    /// Direction of travel
    Direction,
    /// Left wheel forward
    #[strum(to_string = "left-wheel-forward")]
    LeftForward,
    /// Left wheel backward
    #[strum(to_string = "left-wheel-backward")]
    LeftBackward,
    /// Right wheel forward
    #[strum(to_string = "right-wheel-forward")]
    RightForward,
    /// Right wheel backward
    #[strum(to_string = "right-wheel-backward")]
    RightBackward,
    /// Turn rate to the left
    TurnLeft,
    /// Turn rate to the right
    TurnRight,
}

impl RowKind {
    /// The row of a lane barrier by its side.
    pub(crate) fn lane(side: f64) -> Self {
        if side > 0.0 {
            Self::LaneRight
        } else if side < 0.0 {
            Self::LaneLeft
        } else {
            Self::Lane
        }
    }

    /// As in documents.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// Whether the ladder may relax it.
    #[must_use]
    pub fn is_lane(self) -> bool {
        matches!(self, Self::Lane | Self::LaneRight | Self::LaneLeft)
    }
}

/// Rows `a·z ≤ b` over `z = [u_l, u_a, δ1, δ2, δ3]`, at most [`MAX_ROWS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rows {
    kinds: [RowKind; MAX_ROWS],
    rows: [Row; MAX_ROWS],
    count: usize,
}

impl Rows {
    pub(crate) fn new() -> Self {
        Self {
            kinds: [RowKind::Speed; MAX_ROWS],
            rows: [Row {
                a: [0.0; 5],
                b: 0.0,
            }; MAX_ROWS],
            count: 0,
        }
    }

    fn push(&mut self, kind: RowKind, a: [f64; 5], b: f64) {
        debug_assert!(self.count < MAX_ROWS);
        if let Some(row) = self.rows.get_mut(self.count) {
            *row = Row { a, b };
            self.kinds[self.count] = kind;
            self.count += 1;
        }
    }

    /// `L_g V · u − δ ≤ −L_f V − c V` (3.6) with the slack in its own slot.
    pub(crate) fn lyapunov(&mut self, kind: RowKind, slack: usize, v: &Lie, rate_1ps: f64) {
        let mut a = [v.lg[0], v.lg[1], 0.0, 0.0, 0.0];
        a[2 + slack] = -1.0;
        self.push(kind, a, -v.lf - rate_1ps * v.value);
    }

    /// `−L_g h · u ≤ L_f h + γ (h − margin)`
    pub(crate) fn barrier(&mut self, kind: RowKind, h: &Lie, rate_1ps: f64, margin: f64) {
        let a = [-h.lg[0], -h.lg[1], 0.0, 0.0, 0.0];
        self.push(kind, a, h.lf + rate_1ps * (h.value - margin));
    }

    /// The same, but no more than a force asks for.
    pub(crate) fn barrier_up_to(
        &mut self,
        kind: RowKind,
        h: &Lie,
        rate_1ps: f64,
        margin: f64,
        force_n: f64,
    ) {
        let a = [-h.lg[0], -h.lg[1], 0.0, 0.0, 0.0];
        let b = h.lf + rate_1ps * (h.value - margin);
        self.push(kind, a, b.max(-h.lg[0] * force_n));
    }

    /// (2.17) as printed, `L_f h + L_g h · u ≤ γ h`: it limits how fast `h` may grow, and lets it fall.
    pub(crate) fn barrier_as_printed(
        &mut self,
        kind: RowKind,
        h: &Lie,
        rate_1ps: f64,
        margin: f64,
    ) {
        let a = [h.lg[0], h.lg[1], 0.0, 0.0, 0.0];
        self.push(kind, a, rate_1ps * (h.value - margin) - h.lf);
    }

    /// A quantity that stays at or below a limit.
    pub(crate) fn at_most(&mut self, kind: RowKind, quantity: Affine, limit: f64) {
        let [force, torque] = quantity.control;
        self.push(kind, [force, torque, 0.0, 0.0, 0.0], limit - quantity.drift);
    }

    /// Another row in place of those of a kind.
    pub(crate) fn replace(&mut self, kind: RowKind, row: Row) {
        for (own, place) in self.kinds.iter().zip(&mut self.rows).take(self.count) {
            if *own == kind {
                *place = row;
            }
        }
    }

    /// The rows in order.
    #[must_use]
    pub fn as_slice(&self) -> &[Row] {
        &self.rows[..self.count]
    }

    /// What each row stands for, in order.
    #[must_use]
    pub fn kinds(&self) -> &[RowKind] {
        &self.kinds[..self.count]
    }
}
