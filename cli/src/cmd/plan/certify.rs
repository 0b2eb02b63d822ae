//! The optimum of another solver beside that of a plan.

use std::time::Instant;

use assistance::{CertificateDocument, CertificateStatus};
use clap::ValueEnum;
use ev_energy::JOULES_PER_KWH;
use serde::Serialize;
use speed_plan::{Convergence, Demand, Error, Plan, Problem, certify};

use crate::flags::Context;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Certifier {
    /// The planner's own bound
    Bound,
    /// Beside it a convex relaxation, solved by Clarabel; without signals, leader and losses by table
    Convex,
}

impl Certifier {
    pub(super) fn certificate(
        self,
        problem: &Problem,
        demand: Demand,
        plan: &Plan,
        context: &Context,
    ) -> Result<Option<CertificateDocument>, Error> {
        if self == Self::Bound {
            return Ok(None);
        }
        let started = Instant::now();
        let found = certify(problem, demand, &plan.run)?;
        Ok(Some(CertificateDocument {
            solver: "clarabel",
            energy_j: found.energy_j,
            gap_pct: found.gap_pct,
            status: match found.convergence {
                Convergence::Solved => CertificateStatus::Solved,
                Convergence::AlmostSolved => CertificateStatus::AlmostSolved,
                Convergence::Failed => CertificateStatus::Failed,
            },
            solve_ms: (!context.no_times).then(|| 1e3 * started.elapsed().as_secs_f64()),
        }))
    }
}

/// A line about a certificate.
pub(super) fn text(certificate: &CertificateDocument) -> String {
    let (Some(energy_j), Some(gap_pct)) = (certificate.energy_j, certificate.gap_pct) else {
        return "Clarabel did not solve the convex relaxation: it says nothing of the plan\n"
            .to_owned();
    };
    let weaker = match certificate.status {
        CertificateStatus::AlmostSolved => ", at a weaker tolerance",
        CertificateStatus::Solved | CertificateStatus::Failed => "",
    };
    format!(
        "by a convex relaxation no other plan that arrives no later takes less than {:.4} kWh: a gap of {gap_pct:.4} % (Clarabel{weaker})\n",
        energy_j / JOULES_PER_KWH
    )
}
