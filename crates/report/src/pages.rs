//! What each kind of page adds to the frame.

use crate::Page;

/// For the schema `drivekit/evaluate/1`: tables, histograms, predicted speed curves, and figures 3.12 to 3.18.
pub const EVALUATION: Page = Page {
    command: "evaluate",
    title: "Driver model evaluation",
    contents: &[
        ("models", "Models"),
        ("comparison", "Comparison"),
        ("figures", "Figures"),
        ("curves", "Curves"),
        ("bands", "Bands"),
        ("fits", "Function fits"),
        ("systems", "System identification"),
        ("braking", "Braking"),
        ("whole", "Begin to end"),
        ("cruise", "Cruise"),
        ("following", "Following"),
        ("learning", "Learning curve"),
        ("groups", "Speed groups"),
        ("trips", "Held-out trips"),
    ],
    sections: include_str!("../web/evaluate.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/canvas.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/data.js"),
        include_str!("../web/phases.js"),
        include_str!("../web/scores.js"),
        include_str!("../web/comparison.js"),
        include_str!("../web/histograms.js"),
        include_str!("../web/curves.js"),
        include_str!("../web/bands.js"),
        include_str!("../web/reliability.js"),
        include_str!("../web/fits.js"),
        include_str!("../web/systems.js"),
        include_str!("../web/squares.js"),
        include_str!("../web/braking.js"),
        include_str!("../web/driving.js"),
        include_str!("../web/whole.js"),
        include_str!("../web/learning.js"),
        include_str!("../web/main.js"),
    ),
};

/// For the schema `drivekit/segment-compare/1` with its `figures`: Table 3.5 and figures 3.3 to 3.10.
pub const SEGMENTATION: Page = Page {
    command: "segment --compare",
    title: "Segmentation methods compared",
    contents: &[("table", "Table 3.5"), ("figures", "Figures 3.3 to 3.10")],
    sections: include_str!("../web/segments.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/segments.js"),
    ),
};

/// For the schema `drivekit/energy/1`: the flow of energy, power over time, trips and vehicles.
pub const ENERGY: Page = Page {
    command: "energy",
    title: "Where the energy went",
    contents: &[
        ("flow", "Energy flow"),
        ("power", "Power"),
        ("trips", "Trips"),
        ("vehicles", "Vehicles"),
    ],
    sections: include_str!("../web/energy.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/canvas.js"),
        include_str!("../web/sankey.js"),
        include_str!("../web/flow.js"),
        include_str!("../web/power.js"),
        include_str!("../web/energy.js"),
    ),
};

/// For the schema `drivekit/calibrate/1`: parameters with their intervals, errors by trip and residuals.
pub const CALIBRATION: Page = Page {
    command: "calibrate",
    title: "Vehicle calibrated to measured power",
    contents: &[
        ("summary", "Before and after"),
        ("parameters", "Parameters"),
        ("sensitivity", "Sensitivity"),
        ("correlation", "Correlation"),
        ("trips", "Trips"),
        ("residuals", "Residuals"),
    ],
    sections: include_str!("../web/calibrate.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/parameters.js"),
        include_str!("../web/residuals.js"),
        include_str!("../web/calibrate.js"),
    ),
};

/// For the schema `drivekit/portrait/1`: a driver in sentences and pictures.
pub const PORTRAIT: Page = Page {
    command: "portrait",
    title: "Portrait of a driver",
    contents: &[
        ("pace", "Acceleration and braking"),
        ("limits", "Limits"),
        ("headway", "Following"),
        ("smoothness", "Smoothness and energy"),
    ],
    sections: include_str!("../web/portrait.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/portrait-charts.js"),
        include_str!("../web/portrait.js"),
    ),
};

/// For the schema `drivekit/evaluate/1` of the trajectory task: errors by horizon, Table 4.1 and figures 4.4 to 4.11.
pub const TRAJECTORY: Page = Page {
    command: "evaluate --task trajectory",
    title: "Speed ahead",
    contents: &[
        ("horizons", "Horizons"),
        ("trials", "Table 4.1"),
        ("figures", "Figures 4.4 to 4.11"),
        ("free-run", "Free run"),
    ],
    sections: include_str!("../web/trajectory.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/trajectory-horizons.js"),
        include_str!("../web/trajectory-speed.js"),
        include_str!("../web/trajectory-figures.js"),
        include_str!("../web/trajectory-free-run.js"),
        include_str!("../web/trajectory.js"),
    ),
};

/// For the schema `drivekit/ctrl-run/1`: the run played, barriers, Lyapunov functions, ways, steps and their time.
pub const CONTROL: Page = Page {
    command: "ctrl run",
    title: "Robots in a lane",
    contents: &[
        ("view", "The run"),
        ("barriers", "Barriers"),
        ("lyapunov", "Lyapunov functions"),
        ("path", "Ways driven"),
        ("programme", "Quadratic program"),
        ("loop", "Control loop"),
    ],
    sections: include_str!("../web/ctrl.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/canvas.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/ctrl-data.js"),
        include_str!("../web/ctrl-scene.js"),
        include_str!("../web/ctrl-view.js"),
        include_str!("../web/ctrl-charts.js"),
        include_str!("../web/ctrl-barriers.js"),
        include_str!("../web/ctrl-path.js"),
        include_str!("../web/ctrl-programme.js"),
        include_str!("../web/ctrl.js"),
    ),
};

/// For the schema `drivekit/ctrl-campaign/1`: unsafe runs, margins, scenarios and violations.
pub const CAMPAIGN: Page = Page {
    command: "ctrl campaign",
    title: "Campaign of runs",
    contents: &[
        ("totals", "Unsafe runs"),
        ("margins", "Margins"),
        ("scenarios", "Scenarios"),
        ("violations", "Violations"),
    ],
    sections: include_str!("../web/campaign.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/campaign.js"),
    ),
};

/// For the schema `drivekit/plan/1`: a speed plan over the road, energy against time, budget and what was assumed.
pub const PLAN: Page = Page {
    command: "plan",
    title: "Speed plan",
    contents: &[
        ("road", "Over the road"),
        ("frontier", "Energy against time"),
        ("plans", "Plans compared"),
        ("savings", "Where it saves most"),
        ("budget", "Energy budget"),
        ("assumed", "What was assumed"),
    ],
    sections: include_str!("../web/plan.html"),
    script: concat!(
        include_str!("../web/base.js"),
        include_str!("../web/page.js"),
        include_str!("../web/tables.js"),
        include_str!("../web/chart.js"),
        include_str!("../web/plan-road.js"),
        include_str!("../web/plan.js"),
    ),
};
