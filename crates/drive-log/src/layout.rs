//! Which column is which channel, in which unit.

use std::path::Path;

use crate::described::Described;
use crate::header::{Form, Head};
use crate::plan::Plan;
use crate::{Error, canonical, cycle_table, openacc};

/// Which layout a file is read with.
#[derive(Debug, Clone, PartialEq)]
pub enum LayoutChoice {
    /// Recognised from the header.
    Auto,
    /// The built-in layout of this name, one of [`Layout::BUILT_IN`].
    Named(String),
    /// A layout of the user's own, see [`Layout::from_toml_str`].
    Described(Layout),
}

/// Says which column of a file is which channel, in which unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    name: String,
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Canonical,
    /// The canonical layout for headers that are spelled otherwise.
    Spelled,
    Described(Box<Described>),
    OpenAcc,
    CycleTable,
}

/// Name, text, and headers besides time and speed by which a file is recognised: those of the
/// Twizy do not say the unit of the speed, so that another file must not be taken for one.
const DESCRIBED: [(&str, &str, &[&str]); 5] = [
    ("bmw-i3", include_str!("layouts/bmw-i3.toml"), &[]),
    (
        "rsk-twizy",
        include_str!("layouts/rsk-twizy.toml"),
        &["Soc", "Mode", "GpsSpeed", "WindSpeedAv", "SpeedLimit"],
    ),
    ("igdir", include_str!("layouts/igdir.toml"), &[]),
    (
        "nds-br",
        include_str!("layouts/nds-br.toml"),
        &["LIMITE_VEL"],
    ),
    ("cycles", include_str!("layouts/cycles.toml"), &[]),
];

impl Layout {
    /// Names of the built-in layouts.
    ///
    /// - `canonical`: `time_s` or `t`, `speed_mps`, `speed_kmh` or `v`, …: the suffix is the unit
    ///   ([`Channel::name`](crate::Channel::name)).
    /// - `bmw-i3`: BMW i3 trips, doi:10.21227/6jr9-5235; current becomes positive while
    ///   discharging.
    /// - `rsk-twizy`: Renault Twizy trips with the date and the clock as text.
    /// - `openacc`: platoons of the JRC OpenACC campaigns, a log per car.
    /// - `igdir`: time in s, speed in km/h and acceleration without a header.
    /// - `nds-br`: Brazilian Naturalistic Driving Study, trips by number in one file, with speed limits.
    /// - `cycles`: driving cycles, either `cycSecs,cycMps,cycGrade` or the European table in km/h
    ///   with a log per column.
    pub const BUILT_IN: [&'static str; 7] = [
        "canonical",
        "bmw-i3",
        "rsk-twizy",
        "openacc",
        "igdir",
        "nds-br",
        "cycles",
    ];

    /// A layout described in TOML:
    ///
    /// ```
    /// let layout = drive_log::Layout::from_toml_str("my-logger", r#"
    ///     delimiter = ";"        # sniffed if left out, as is
    ///     decimal = ","          # the decimal mark
    ///     skip_lines = 2         # lines before the header
    ///     time = { header = "Zeit [ms]", unit = "ms" }
    ///
    ///     [channels]
    ///     speed = { header = "Velocity [km/h]", unit = "km/h" }
    ///     battery_current = { header = "I_bat", unit = "A", sign = -1 }
    /// "#)?;
    /// # Ok::<(), drive_log::Error>(())
    /// ```
    ///
    /// The keys of `channels` are canonical headers without their unit. Headers are compared
    /// without regard to case, blanks and kind of brackets. Without a header (`no_header = true`)
    /// give `column = 1` and so on in place of `header`, as where two columns have the same header.
    /// Time as text is `time = { date = "Date", clock = "Time" }`, or `time = { header = "Time" }`
    /// without a unit; `date_order = "dmy"` or `"mdy"` says what 03/04/2026 is. `split_by =
    /// ["Trip"]` names the columns that divide the file into drives (`[]`: none does), `missing =
    /// ["ND"]` words for missing values.
    ///
    /// # Errors
    /// [`Error::Layout`] for anything that is not such a description, with what is wrong and what
    /// is known.
    pub fn from_toml_str(name: &str, text: &str) -> Result<Layout, Error> {
        let described = Described::from_toml_str(name, text, true)?;
        Ok(Layout {
            name: name.to_owned(),
            kind: Kind::Described(Box::new(described)),
        })
    }

    /// Name of the layout.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn built_in(name: &str) -> Result<Vec<Layout>, Error> {
        let of = |kind| Layout {
            name: name.to_owned(),
            kind,
        };
        let mut layouts = Vec::new();
        if let Some((_, text, _)) = DESCRIBED.iter().find(|(known, _, _)| *known == name) {
            layouts.push(of(Kind::Described(Box::new(Described::from_toml_str(
                name, text, false,
            )?))));
        }
        match name {
            "canonical" => layouts.push(of(Kind::Canonical)),
            "openacc" => layouts.push(of(Kind::OpenAcc)),
            "cycles" => layouts.push(of(Kind::CycleTable)),
            _ => {}
        }
        Ok(layouts)
    }

    /// The layouts that may apply to a file, in the order in which they are tried.
    pub(crate) fn candidates(choice: &LayoutChoice) -> Result<Vec<Layout>, Error> {
        match choice {
            LayoutChoice::Described(layout) => Ok(vec![layout.clone()]),
            LayoutChoice::Named(name) if Layout::BUILT_IN.contains(&name.as_str()) => {
                Layout::built_in(name)
            }
            LayoutChoice::Named(name) => Err(Error::UnknownLayoutName {
                name: name.clone(),
                known: Layout::BUILT_IN.join(", "),
            }),
            LayoutChoice::Auto => {
                // What is recognised by several headers comes before what is by two.
                let is_sure = |name: &str| {
                    let described = DESCRIBED.iter().find(|(known, _, _)| *known == name);
                    described.is_some_and(|(_, _, further)| !further.is_empty())
                };
                let (sure, others): (Vec<_>, Vec<_>) =
                    Layout::BUILT_IN.into_iter().partition(|name| is_sure(name));
                let mut layouts = Vec::new();
                for name in sure.into_iter().chain(others) {
                    layouts.extend(Layout::built_in(name)?);
                }
                layouts.push(Layout {
                    name: "canonical".to_owned(),
                    kind: Kind::Spelled,
                });
                Ok(layouts)
            }
        }
    }

    /// How the text is laid out, as far as the layout says.
    pub(crate) fn form(&self) -> Form {
        match &self.kind {
            Kind::Described(described) => described.form,
            Kind::OpenAcc => Form {
                skip_lines: openacc::LINES_BEFORE_HEADER,
                ..Form::default()
            },
            Kind::Canonical | Kind::Spelled | Kind::CycleTable => Form::default(),
        }
    }

    /// Whether a file with these headers is meant for this layout.
    pub(crate) fn claims(&self, head: &Head) -> bool {
        match &self.kind {
            Kind::Canonical => canonical::claims(&head.headers),
            Kind::Spelled => canonical::claims_spelled(&head.headers),
            Kind::Described(described) => {
                let further = DESCRIBED.iter().find(|(name, _, _)| *name == self.name);
                let there = |header: &&str| head.headers.iter().any(|h| h.trim() == *header);
                described.claims(head)
                    && further.is_none_or(|(_, _, further)| further.iter().all(there))
            }
            Kind::OpenAcc => openacc::claims(head),
            Kind::CycleTable => cycle_table::claims(&head.headers),
        }
    }

    /// Which columns to read, and what they become.
    pub(crate) fn plan(&self, path: &Path, head: &Head) -> Result<Plan, Error> {
        match &self.kind {
            Kind::Canonical | Kind::Spelled => canonical::plan(path, &head.headers),
            Kind::Described(described) => described.plan(path, head),
            Kind::OpenAcc => openacc::plan(path, head),
            Kind::CycleTable => cycle_table::plan(path, &head.headers),
        }
    }
}
