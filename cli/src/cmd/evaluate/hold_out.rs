//! Flags that say what is held out at a time.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use anyhow::ensure;
use clap::Args;
use drive_log::LayoutChoice;
use driver_eval::Error;
use driver_eval::units::{DriveSource, DriverBy, UnitKind, Units};
use serde::Serialize;

use crate::flags::Context;
use crate::inputs::Input;
use crate::names::named;
use crate::output;

#[derive(Debug, Clone, Args, Serialize)]
pub(super) struct HoldOutArgs {
    /// What is held out at a time
    #[arg(long, value_parser = named::<UnitKind>(), default_value = UnitKind::Trip.name(), value_name = "UNIT")]
    hold_out: UnitKind,
    /// Folder that is a driver, counted from the file up: 1 is the folder of the file [default: the topmost in which the logs
    /// differ]
    #[arg(long, value_parser = level, value_name = "N")]
    driver_level: Option<usize>,
    /// Column of the logs that names the driver, in place of folders
    #[arg(long, conflicts_with = "driver_level", value_name = "HEADER")]
    driver_column: Option<String>,
}

fn level(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(level) if level > 0 => Ok(level),
        _ => Err("expected a number of folders, at least 1".to_owned()),
    }
}

impl HoldOutArgs {
    /// Names the unit of every drive, and says what was taken for a driver.
    pub(super) fn units(
        &self,
        inputs: &[Input],
        layout: &LayoutChoice,
        context: &Context,
    ) -> anyhow::Result<Units> {
        let says_driver = self.driver_level.is_some() || self.driver_column.is_some();
        ensure!(
            !says_driver || self.hold_out == UnitKind::Driver,
            "--driver-level and --driver-column say what a driver is; give --hold-out driver with them"
        );
        let mut files = BTreeMap::new();
        let origins = inputs
            .iter()
            .map(|input| self.origin(input, layout, &mut files));
        let origins: Vec<BTreeMap<String, String>> = origins.collect::<anyhow::Result<_>>()?;
        let places: Vec<String> = inputs.iter().map(Input::place).collect();
        let sources = inputs
            .iter()
            .zip(&places)
            .zip(&origins)
            .map(|((input, place), origin)| DriveSource {
                path: &input.path,
                name: &input.drive.name,
                place,
                origin,
            });
        let sources: Vec<DriveSource<'_>> = sources.collect();
        match self.hold_out {
            UnitKind::Trip => Ok(Units::by_drive(&sources)),
            UnitKind::File => Ok(Units::by_file(&sources)),
            UnitKind::Driver => {
                let units = Units::by_driver(&sources, &self.driver_by()).map_err(with_flags)?;
                output::note(context, &units.drivers_in_words());
                Ok(units)
            }
        }
    }

    /// What the file says of the drive, with the column that names the driver whatever it is called; each of the `files` is read once.
    fn origin<'a>(
        &self,
        input: &'a Input,
        layout: &LayoutChoice,
        files: &mut BTreeMap<&'a str, BTreeMap<String, String>>,
    ) -> anyhow::Result<BTreeMap<String, String>> {
        let mut origin = input.drive.origin.clone();
        let path = Path::new(&input.path);
        let Some(column) = self.driver_column.as_ref().filter(|_| path.is_file()) else {
            return Ok(origin);
        };
        if !origin
            .keys()
            .any(|header| header.eq_ignore_ascii_case(column))
        {
            let drivers = match files.entry(&input.path) {
                Entry::Occupied(read) => read.into_mut(),
                Entry::Vacant(file) => {
                    file.insert(drive_log::constants_of_column(path, layout, column)?)
                }
            };
            let driver = drivers.get(&input.drive.name);
            origin.extend(driver.map(|driver| (column.clone(), driver.clone())));
        }
        Ok(origin)
    }

    fn driver_by(&self) -> DriverBy {
        match (&self.driver_column, self.driver_level) {
            (Some(column), _) => DriverBy::Column(column.clone()),
            (None, Some(level)) => DriverBy::FolderAbove(level),
            (None, None) => DriverBy::TopmostFolder,
        }
    }
}

fn with_flags(error: Error) -> anyhow::Error {
    match error {
        Error::OneDriver { .. } => anyhow::anyhow!(
            "--hold-out driver: {error}, or say with --driver-level which folder, or with --driver-column which column, names \
             the driver"
        ),
        error => error.into(),
    }
}
