use crate::GRAVITY_MPS2;
use crate::battery::Cells;
use crate::jet::{Jet, positive_part};
use crate::road_load::RoadLoad;
use crate::step::RoadStep;
use crate::vehicle::Vehicle;

/// What the energy of a [`RoadStep`] is made of, where motor losses are a formula.
///
/// With the mean speed `w`, the acceleration `a` and the force `F = m_eff a + A cos θ + B w + C w² + m g sin θ`:
///
/// ```text
/// G     = max(F, −R(w))                                     force of the motor, the rest is braked by friction
/// T     = γ_p G where G ≥ 0, γ_b G where G < 0
/// P     = T c w + k_c T² + L(w)                             L(w) = k_i c w + k_w c³ w³ + K + k_f max(0, 1 − w_f/w)
/// P_bat = 2 P U0/(U0 + √(U0² − 4 R P))
/// R(w)  = clamp((w − w₀)/(w₁ − w₀), 0, 1) · min(N, W/w)
/// ```
///
/// Limits of propulsion are not part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepFormula {
    /// `m_eff`, kg.
    pub effective_mass_kg: f64,
    /// `m g`, N.
    pub weight_n: f64,
    /// `A`, N.
    pub rolling_n: f64,
    /// `B`, N/(m/s).
    pub linear_n_per_mps: f64,
    /// `C`, N/(m/s)².
    pub quadratic_n_per_mps2: f64,
    /// `γ_p`, N m/N.
    pub propelling_nm_per_n: f64,
    /// `γ_b`, N m/N.
    pub braking_nm_per_n: f64,
    /// `c`, rad/s per m/s.
    pub motor_speed_per_mps: f64,
    /// `k_c`, W/(N m)².
    pub copper_w_per_nm2: f64,
    /// `k_i c`, W/(m/s).
    pub iron_w_per_mps: f64,
    /// `k_w c³`, W/(m/s)³.
    pub windage_w_per_mps3: f64,
    /// `K`, constant loss of the motor and auxiliaries, W.
    pub constant_w: f64,
    /// `k_f`, W.
    pub weakening_w: f64,
    /// `w_f`, m/s.
    pub weakening_from_mps: f64,
    /// `U0`, V.
    pub voltage_v: f64,
    /// `R` of the battery, Ω.
    pub resistance_ohm: f64,
    /// `N`, the smaller of the limits of regeneration by torque and by deceleration, N.
    pub regeneration_n: f64,
    /// `W`, the smaller of its limits by power, W at the wheel.
    pub regeneration_w: f64,
    /// `w₀`, m/s.
    pub fade_start_mps: f64,
    /// `w₁`, m/s.
    pub fade_end_mps: f64,
}

/// Widths over which kinks are rounded; above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinkWidths {
    /// Of those between propulsion, regeneration and friction brakes, where `max(x, 0)` becomes `½(x + √(x² + width²))`, N; and of
    /// the limit of regeneration, where a polynomial within the width of 0 takes its place.
    pub force_n: f64,
    /// Of the fade of regeneration and of field weakening, by that polynomial, 1.
    pub fade: f64,
}

/// Energy and time of a step with their derivatives by the squares of its speeds, from [`StepFormula::step`].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SmoothStep {
    /// Energy, J.
    pub energy_j: f64,
    /// Its gradient by `(v₀², v₁²)`, J/(m/s)².
    pub energy_gradient: [f64; 2],
    /// Its second derivatives `[00, 01, 11]`, J/(m/s)⁴.
    pub energy_hessian: [f64; 3],
    /// Time, s.
    pub time_s: f64,
    /// Its gradient, s/(m/s)².
    pub time_gradient: [f64; 2],
    /// Its second derivatives `[00, 01, 11]`, s/(m/s)⁴.
    pub time_hessian: [f64; 3],
}

impl StepFormula {
    pub(crate) fn new(
        vehicle: &Vehicle,
        road_load: &RoadLoad,
        cells: &Cells,
        auxiliary_power_w: f64,
    ) -> Option<Self> {
        let loss = vehicle.motor.loss_formula()?;
        let c = vehicle.motor_speed_per_mps;
        let regeneration = vehicle.motor.regeneration_bounds();
        let spec = vehicle.spec();
        Some(Self {
            effective_mass_kg: vehicle.effective_mass_kg,
            weight_n: spec.mass_kg * GRAVITY_MPS2,
            rolling_n: road_load.constant_n,
            linear_n_per_mps: road_load.linear_n_per_mps,
            quadratic_n_per_mps2: road_load.quadratic_n_per_mps2,
            propelling_nm_per_n: vehicle.propelling_nm_per_n,
            braking_nm_per_n: vehicle.braking_nm_per_n,
            motor_speed_per_mps: c,
            copper_w_per_nm2: loss.copper_w_per_nm2,
            iron_w_per_mps: loss.iron_w_per_rad_s * c,
            windage_w_per_mps3: loss.windage_w_per_rad3_s3 * c * c * c,
            constant_w: loss.constant_w + auxiliary_power_w,
            weakening_w: loss.weakening_w,
            weakening_from_mps: loss.weakening_from_rad_s / c,
            voltage_v: cells.voltage_v(),
            resistance_ohm: spec.battery.resistance_ohm,
            regeneration_n: regeneration.torque_nm * vehicle.braking_n_per_nm,
            regeneration_w: regeneration.power_w * vehicle.braking_n_per_nm / c,
            fade_start_mps: spec.regeneration.fade_start_mps,
            fade_end_mps: spec.regeneration.fade_end_mps,
        })
    }

    /// Force without acceleration at speed 0 in a step, `A cos θ + m g sin θ`, N.
    #[must_use]
    pub fn standing_force_n(&self, step: &RoadStep) -> f64 {
        self.rolling_n * step.cos_slope() + self.weight_n * step.sin_slope()
    }

    /// Largest force of regeneration in N at a mean speed in m/s above 0.
    #[must_use]
    pub fn regeneration_limit_n(&self, speed_mps: f64) -> f64 {
        let fade = (speed_mps - self.fade_start_mps) / (self.fade_end_mps - self.fade_start_mps);
        fade.clamp(0.0, 1.0) * self.regeneration_n.min(self.regeneration_w / speed_mps)
    }

    /// Energy and time between two squared speeds in (m/s)², at least one above 0, with rounded kinks. Derivatives by a speed that is
    /// 0 are given as 0.
    #[must_use]
    pub fn step(
        &self,
        step: &RoadStep,
        from_m2ps2: f64,
        to_m2ps2: f64,
        widths: KinkWidths,
    ) -> SmoothStep {
        let (v0, v1) = (from_m2ps2.sqrt(), to_m2ps2.sqrt());
        let w = 0.5 * (v0 + v1);
        let length_m = step.length_m();
        let a = (to_m2ps2 - from_m2ps2) / (2.0 * length_m);
        let inverse = |v: f64| if v > 0.0 { 1.0 / v } else { 0.0 };
        let (i0, i1) = (inverse(v0), inverse(v1));
        // dw/dz and d²w/dz², da/dz
        let (w0, w1) = (0.25 * i0, 0.25 * i1);
        let (w00, w11) = (-0.125 * i0 * i0 * i0, -0.125 * i1 * i1 * i1);
        let a1 = 0.5 / length_m;

        let dt = length_m / w;
        let (dt_w, dt_ww) = (-dt / w, 2.0 * dt / (w * w));
        let power = self.power(w, a, self.standing_force_n(step), widths);
        // E = P Δt
        let e_w = power.w * dt + power.value * dt_w;
        let e_a = power.a * dt;
        let e_ww = power.ww * dt + 2.0 * power.w * dt_w + power.value * dt_ww;
        let e_wa = power.wa * dt + power.a * dt_w;
        let e_aa = power.aa * dt;
        SmoothStep {
            energy_j: power.value * dt,
            energy_gradient: [e_w * w0 - e_a * a1, e_w * w1 + e_a * a1],
            energy_hessian: [
                e_ww * w0 * w0 - 2.0 * e_wa * w0 * a1 + e_aa * a1 * a1 + e_w * w00,
                e_ww * w0 * w1 + e_wa * a1 * (w0 - w1) - e_aa * a1 * a1,
                e_ww * w1 * w1 + 2.0 * e_wa * w1 * a1 + e_aa * a1 * a1 + e_w * w11,
            ],
            time_s: dt,
            time_gradient: [dt_w * w0, dt_w * w1],
            time_hessian: [
                dt_ww * w0 * w0 + dt_w * w00,
                dt_ww * w0 * w1,
                dt_ww * w1 * w1 + dt_w * w11,
            ],
        }
    }

    /// `P_bat` over speed and acceleration.
    #[inline(always)]
    fn power(&self, w: f64, a: f64, standing_force_n: f64, widths: KinkWidths) -> Jet {
        let (b, c) = (self.linear_n_per_mps, self.quadratic_n_per_mps2);
        let force = Jet {
            value: self.effective_mass_kg * a + standing_force_n + (b + c * w) * w,
            w: b + 2.0 * c * w,
            a: self.effective_mass_kg,
            ww: 2.0 * c,
            ..Jet::default()
        };
        let regeneration = self.regeneration_limit(w, widths);
        let motor = (force + regeneration).positive_part(widths.force_n) - regeneration;
        let torque = motor.positive_part(widths.force_n)
            * (self.propelling_nm_per_n - self.braking_nm_per_n)
            + motor * self.braking_nm_per_n;
        let electric = torque.squared() * self.copper_w_per_nm2
            + torque.times_speed(w) * self.motor_speed_per_mps
            + self.idle_loss(w, widths);
        electric.map(|power| self.cells_power(power))
    }

    /// [`SmoothStep::energy_j`] and [`SmoothStep::time_s`] alone, for less.
    #[must_use]
    pub fn energy_and_time(
        &self,
        step: &RoadStep,
        from_m2ps2: f64,
        to_m2ps2: f64,
        widths: KinkWidths,
    ) -> (f64, f64) {
        let w = 0.5 * (from_m2ps2.sqrt() + to_m2ps2.sqrt());
        let a = (to_m2ps2 - from_m2ps2) / (2.0 * step.length_m());
        let force = self.effective_mass_kg * a
            + self.standing_force_n(step)
            + (self.linear_n_per_mps + self.quadratic_n_per_mps2 * w) * w;
        let regeneration = self.regeneration_limit(w, widths).value;
        let motor = positive_part(force + regeneration, widths.force_n)[0] - regeneration;
        let torque = positive_part(motor, widths.force_n)[0]
            * (self.propelling_nm_per_n - self.braking_nm_per_n)
            + motor * self.braking_nm_per_n;
        let electric_w = torque * (torque * self.copper_w_per_nm2 + w * self.motor_speed_per_mps)
            + self.idle_loss(w, widths).value;
        let time_s = step.length_m() / w;
        (self.cells_power(electric_w)[0] * time_s, time_s)
    }

    #[inline(always)]
    fn regeneration_limit(&self, w: f64, widths: KinkWidths) -> Jet {
        let by_power = Jet {
            value: self.regeneration_w / w,
            w: -self.regeneration_w / (w * w),
            ww: 2.0 * self.regeneration_w / (w * w * w),
            ..Jet::default()
        };
        let by_force = Jet::constant(self.regeneration_n);
        // min(x, y) = y − max(y − x, 0)
        let limit = by_force - (by_force - by_power).rounded_part(widths.force_n);
        let per_mps = 1.0 / (self.fade_end_mps - self.fade_start_mps);
        let share = Jet {
            value: (w - self.fade_start_mps) * per_mps,
            w: per_mps,
            ..Jet::default()
        };
        if share.value >= 1.0 + widths.fade {
            return limit;
        }
        let beyond = share - Jet::constant(1.0);
        (share.rounded_part(widths.fade) - beyond.rounded_part(widths.fade)).times(limit)
    }

    /// `L(w)`.
    #[inline(always)]
    fn idle_loss(&self, w: f64, widths: KinkWidths) -> Jet {
        let spin = Jet {
            value: self.constant_w + (self.iron_w_per_mps + self.windage_w_per_mps3 * w * w) * w,
            w: self.iron_w_per_mps + 3.0 * self.windage_w_per_mps3 * w * w,
            ww: 6.0 * self.windage_w_per_mps3 * w,
            ..Jet::default()
        };
        if self.weakening_w <= 0.0 || self.weakening_from_mps <= 0.0 {
            return spin;
        }
        let from = self.weakening_from_mps;
        let beyond = Jet {
            value: 1.0 - from / w,
            w: from / (w * w),
            ww: -2.0 * from / (w * w * w),
            ..Jet::default()
        };
        spin + beyond.rounded_part(widths.fade) * self.weakening_w
    }

    /// Power from the cells for one at the terminals, with its first and second derivative.
    #[must_use]
    #[inline]
    pub fn cells_power(&self, electric_power_w: f64) -> [f64; 3] {
        let u = self.voltage_v;
        let discriminant = u * u - 4.0 * self.resistance_ohm * electric_power_w;
        // At the limit of the battery the slope has a pole; a plan stays inside.
        let root = discriminant.max(1e-6 * u * u).sqrt();
        [
            2.0 * electric_power_w * u / (u + root),
            u / root,
            2.0 * self.resistance_ohm * u / (root * root * root),
        ]
    }
}
