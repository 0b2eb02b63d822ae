use super::braking::Braking;
use super::driver::PhaseHabit;
use super::random::Random;
use super::route::{LegEnd, Route};
use super::settings::SynthSettings;
use super::traffic::Traffic;
use super::true_phase::{Regime, TruePhase};
use driver_model::segmentation::INFLUENCE_GAP_S;

/// The motion of one drive as it really is, before any sensor.
#[derive(Debug)]
pub(super) struct Motion {
    pub(super) speed_mps: Vec<f64>,
    pub(super) position_m: Vec<f64>,
    /// Not a number where no vehicle is ahead, as the next one.
    pub(super) lead_gap_m: Vec<f64>,
    pub(super) lead_speed_mps: Vec<f64>,
    pub(super) phases: Vec<TruePhase>,
}

/// A driver speeds up when this much is missing to the speed wanted; less is left to cruising.
const WORTH_ACCELERATING_MPS: f64 = 1.6;

/// A driver brakes ahead of a sign when this much is too much.
const WORTH_BRAKING_MPS: f64 = 0.3;

/// Cruising corrects speed no faster than this.
const CRUISE_ACCEL_MPS2: f64 = 0.6;

/// Cruising and following change acceleration no faster than this.
const JERK_MPS3: f64 = 4.0;

/// A leader takes over when following asks for this much less acceleration than driving freely, or than braking for the
/// end of the leg. That braking waits behind a leader until no more than a share of its time is left. Without such
/// margins the plans would take turns.
const TAKEOVER_MPS2: f64 = 0.2;
const TAKEOVER_BRAKING_MPS2: f64 = 0.7;
const BRAKING_PATIENCE: f64 = 0.8;

/// What following asks for is looked at over this time at least: over a shorter one, the jerk leaves less than the margins.
const TAKEOVER_S: f64 = 0.1;

/// Whatever the plan, the car can stop this far behind its leader with this deceleration.
const NEAREST_M: f64 = 1.0;
const SAFE_BRAKING_MPS2: f64 = 4.0;

/// Below this speed a leader matters as near as at it; at standstill every gap would be wide enough.
const SLOWEST_INFLUENCE_MPS: f64 = 5.0;

/// Spread of the logarithm of the braking pace at variation 1.
const BRAKING_LOG_SPREAD: f64 = 0.15;

/// How the driver means to take one leg.
struct LegHabit {
    cruise_mps: f64,
    braking_pace: f64,
}

/// What the driver is about to do.
enum Plan {
    Standstill { until: usize },
    Accelerate { curve: Vec<f64>, at: usize },
    Cruise { deviation_mps: f64 },
    Follow,
    Brake { braking: Braking, elapsed_s: f64 },
}

/// A driver on the road.
struct Ride<'a> {
    settings: &'a SynthSettings,
    route: &'a Route,
    habits: Vec<LegHabit>,
    random: Random,
    traffic: Traffic,
    leg: usize,
    position_m: f64,
    speed_mps: f64,
    /// Over the last step.
    accel_mps2: f64,
    plan: Plan,
    phase: TruePhase,
    phases: Vec<TruePhase>,
}

/// Drives the route for the time set.
pub(super) fn drive(
    settings: &SynthSettings,
    route: &Route,
    mut random: Random,
    traffic: Traffic,
) -> Motion {
    let samples = settings.samples();
    let habits = (0..=route.legs())
        .map(|leg| LegHabit::draw(&mut random, settings, route.leg(leg).limit_mps))
        .collect();
    let wait_s = random.between(2.0, 6.0);
    let mut ride = Ride {
        settings,
        route,
        habits,
        random,
        traffic,
        leg: 0,
        position_m: 0.0,
        speed_mps: 0.0,
        accel_mps2: 0.0,
        plan: Plan::Standstill {
            until: (wait_s / settings.step_s) as usize,
        },
        phase: TruePhase::open(Regime::Standstill, 0, 0.0, 0.0),
        phases: Vec::new(),
    };
    let mut motion = Motion {
        speed_mps: Vec::with_capacity(samples),
        position_m: Vec::with_capacity(samples),
        lead_gap_m: Vec::with_capacity(samples),
        lead_speed_mps: Vec::with_capacity(samples),
        phases: Vec::new(),
    };
    for k in 0..samples {
        if k > 0 {
            ride.step(k - 1);
        }
        ride.look(k);
        let leader = ride.traffic.leader;
        motion.speed_mps.push(ride.speed_mps);
        motion.position_m.push(ride.position_m);
        motion
            .lead_gap_m
            .push(leader.map_or(f64::NAN, |l| l.gap_m(ride.position_m)));
        motion
            .lead_speed_mps
            .push(leader.map_or(f64::NAN, |l| l.speed_mps));
    }
    ride.close(samples - 1);
    motion.phases = ride.phases;
    motion
}

impl LegHabit {
    fn draw(random: &mut Random, settings: &SynthSettings, limit_mps: f64) -> Self {
        let cruise = &settings.driver.cruise;
        let spread_mps = random.habit(settings.variation * cruise.bias_spread_mps);
        Self {
            cruise_mps: limit_mps + cruise.bias_mps + spread_mps,
            braking_pace: random.habit(settings.variation * BRAKING_LOG_SPREAD).exp(),
        }
    }
}

impl Ride<'_> {
    fn cruise_mps(&self, leg: usize) -> f64 {
        self.habits[leg.min(self.habits.len() - 1)].cruise_mps
    }

    /// Changes the plan where the road, the traffic or the end of the plan asks for it.
    fn look(&mut self, k: usize) {
        let may_cut_in = matches!(self.plan, Plan::Accelerate { .. } | Plan::Cruise { .. });
        let time_s = k as f64 * self.settings.step_s;
        self.traffic
            .update(time_s, self.position_m, self.speed_mps, may_cut_in);
        match self.plan {
            Plan::Standstill { until } if k < until => return,
            Plan::Standstill { .. } => self.go_on(k),
            Plan::Accelerate { ref curve, at, .. } if at + 1 >= curve.len() => self.go_on(k),
            Plan::Brake { braking, elapsed_s } if elapsed_s < braking.duration_s => return,
            Plan::Brake { .. } => return self.arrive(k),
            Plan::Follow if self.follow_accel_mps2().is_none() => self.go_on(k),
            _ => {}
        }
        while self.position_m >= self.route.leg(self.leg).end_m {
            self.leg += 1;
        }
        if !self.brake_ahead(k) && matches!(self.plan, Plan::Cruise { .. }) && self.too_slow() {
            self.go_on(k);
        }
    }

    fn too_slow(&self) -> bool {
        self.cruise_mps(self.leg) - self.speed_mps > WORTH_ACCELERATING_MPS
    }

    /// Goes for the speed wanted on this leg.
    fn go_on(&mut self, k: usize) {
        let target_mps = self.cruise_mps(self.leg);
        if self.too_slow() {
            let habit = PhaseHabit::draw(&mut self.random, self.settings.variation);
            let driver = &self.settings.driver;
            let step_s = self.settings.step_s;
            let curve = driver.acceleration_curve(self.speed_mps, target_mps, step_s, &habit);
            let plan = Plan::Accelerate { curve, at: 0 };
            self.begin(k, plan, Regime::Acceleration, target_mps);
        } else {
            let plan = Plan::Cruise { deviation_mps: 0.0 };
            self.begin(k, plan, Regime::Cruise, target_mps);
        }
    }

    /// Starts to brake where the end of the leg is near enough.
    fn brake_ahead(&mut self, k: usize) -> bool {
        let leg = self.route.leg(self.leg);
        let next_mps = self.cruise_mps(self.leg + 1);
        let to_mps = match leg.end {
            LegEnd::Sign => next_mps,
            LegEnd::Turn { speed_mps } => next_mps.min(speed_mps),
            LegEnd::Stop { .. } => 0.0,
        };
        if self.speed_mps - to_mps < WORTH_BRAKING_MPS {
            return false;
        }
        let pace = self.habits[self.leg.min(self.habits.len() - 1)].braking_pace;
        let wanted_s = self
            .settings
            .driver
            .braking_pace
            .duration_s(self.speed_mps, to_mps)
            / pace;
        let left_m = (leg.end_m - self.position_m).max(0.0);
        let braking = Braking::over(self.speed_mps, self.accel_mps2, to_mps, left_m);
        let following = matches!(self.plan, Plan::Follow);
        if braking.duration_s
            > if following {
                BRAKING_PATIENCE * wanted_s
            } else {
                wanted_s
            }
        {
            return false;
        }
        if leg.end != LegEnd::Sign {
            // The leader goes straight on, or was the last to pass.
            self.traffic.clear(k as f64 * self.settings.step_s);
        }
        let plan = Plan::Brake {
            braking,
            elapsed_s: 0.0,
        };
        self.begin(k, plan, Regime::Braking, to_mps);
        true
    }

    /// Braking has reached the end of the leg.
    fn arrive(&mut self, k: usize) {
        let end = self.route.leg(self.leg).end;
        self.leg += 1;
        if let LegEnd::Stop { dwell_s } = end {
            let until = k + (dwell_s / self.settings.step_s) as usize;
            self.begin(k, Plan::Standstill { until }, Regime::Standstill, 0.0);
        } else {
            self.go_on(k);
        }
    }

    /// What following asks for, where a leader is near enough to matter.
    fn follow_accel_mps2(&self) -> Option<f64> {
        let leader = self.traffic.leader?;
        let gap_m = leader.gap_m(self.position_m);
        let v = self.speed_mps;
        let desired_mps = self.cruise_mps(self.leg);
        (gap_m < INFLUENCE_GAP_S * v.max(SLOWEST_INFLUENCE_MPS)).then(|| {
            self.settings
                .driver
                .following
                .accel_mps2(v, desired_mps, gap_m, leader.speed_mps)
        })
    }

    /// Drives on to the next sample, as planned or as a leader allows.
    fn step(&mut self, k: usize) {
        let step_s = self.settings.step_s;
        let planned_mps = self.planned_mps();
        let mut next_mps = planned_mps;
        if let Some(accel_mps2) = self.follow_accel_mps2() {
            let margin_mps2 = match self.plan {
                Plan::Follow => 0.0,
                Plan::Brake { .. } => TAKEOVER_BRAKING_MPS2,
                _ => TAKEOVER_MPS2,
            };
            let meant_mps = self.eased_within_mps(accel_mps2, step_s.max(TAKEOVER_S));
            if meant_mps < planned_mps - margin_mps2 * step_s {
                next_mps = self.eased_mps(accel_mps2);
                self.begin_following(k);
            }
        }
        if let Some(safe_mps) = self.safe_mps().filter(|safe_mps| *safe_mps < next_mps) {
            next_mps = safe_mps;
            self.begin_following(k);
        }
        match &mut self.plan {
            Plan::Accelerate { at, .. } => *at += 1,
            Plan::Brake { elapsed_s, .. } => *elapsed_s += step_s,
            Plan::Standstill { .. } | Plan::Cruise { .. } | Plan::Follow => {}
        }
        self.position_m += 0.5 * (self.speed_mps + next_mps) * step_s;
        self.accel_mps2 = (next_mps - self.speed_mps) / step_s;
        self.speed_mps = next_mps;
        self.traffic.advance(k as f64 * step_s, step_s, self.route);
    }

    fn begin_following(&mut self, k: usize) {
        if !matches!(self.plan, Plan::Follow) {
            let target_mps = self.cruise_mps(self.leg);
            self.begin(k, Plan::Follow, Regime::Following, target_mps);
        }
    }

    /// The highest speed from which braking ends behind a leader that brakes as hard, after P. G. Gipps, A behavioural
    /// car-following model for computer simulation, Transportation Research Part B 15, 1981.
    fn safe_mps(&self) -> Option<f64> {
        let leader = self.traffic.leader?;
        let step_s = self.settings.step_s;
        let gap_m = leader.gap_m(self.position_m) - NEAREST_M - 0.5 * self.speed_mps * step_s;
        let delay_mps = SAFE_BRAKING_MPS2 * 0.5 * step_s;
        let square = delay_mps.powi(2) + leader.speed_mps.powi(2) + 2.0 * SAFE_BRAKING_MPS2 * gap_m;
        Some((square.max(0.0).sqrt() - delay_mps).max(0.0))
    }

    /// Speed at the next sample for a wanted acceleration, with the jerk limited.
    fn eased_mps(&self, wanted_mps2: f64) -> f64 {
        self.eased_within_mps(wanted_mps2, self.settings.step_s)
    }

    /// The same where the acceleration has this long to change.
    fn eased_within_mps(&self, wanted_mps2: f64, within_s: f64) -> f64 {
        let change_mps2 = JERK_MPS3 * within_s;
        let (least, most) = (self.accel_mps2 - change_mps2, self.accel_mps2 + change_mps2);
        (self.speed_mps + wanted_mps2.clamp(least, most) * self.settings.step_s).max(0.0)
    }

    fn planned_mps(&mut self) -> f64 {
        let step_s = self.settings.step_s;
        match &mut self.plan {
            Plan::Standstill { .. } => 0.0,
            Plan::Accelerate { curve, at, .. } => curve[*at + 1],
            Plan::Cruise { deviation_mps } => {
                let cruise = &self.settings.driver.cruise;
                let kept = (-step_s / cruise.correlation_s).exp();
                let spread_mps = self.settings.variation * cruise.deviation_mps;
                let drawn_mps = spread_mps * (1.0 - kept * kept).sqrt() * self.random.normal();
                *deviation_mps = kept * *deviation_mps + drawn_mps;
                let wanted_mps = *deviation_mps + self.cruise_mps(self.leg);
                let wanted_mps2 = (wanted_mps - self.speed_mps) / cruise.response_s;
                self.eased_mps(wanted_mps2.clamp(-CRUISE_ACCEL_MPS2, CRUISE_ACCEL_MPS2))
            }
            Plan::Follow => f64::INFINITY,
            Plan::Brake { braking, elapsed_s } => braking.speed_mps(*elapsed_s + step_s),
        }
    }

    fn begin(&mut self, k: usize, plan: Plan, regime: Regime, target_mps: f64) {
        self.close(k);
        self.plan = plan;
        self.phase = TruePhase::open(regime, k, self.speed_mps, target_mps);
    }

    /// Ends the present phase at sample `k`. A phase without a step is none, and following goes on after a short break.
    fn close(&mut self, k: usize) {
        if k == self.phase.start {
            return;
        }
        let mut phase = self.phase;
        phase.end = k + 1;
        phase.complete = match &self.plan {
            Plan::Accelerate { curve, at, .. } => at + 1 >= curve.len(),
            Plan::Brake { braking, elapsed_s } => *elapsed_s >= braking.duration_s,
            Plan::Standstill { .. } | Plan::Cruise { .. } | Plan::Follow => true,
        };
        match self.phases.last_mut() {
            Some(last) if last.regime == phase.regime && phase.regime == Regime::Following => {
                last.end = phase.end;
            }
            _ => self.phases.push(phase),
        }
    }
}
