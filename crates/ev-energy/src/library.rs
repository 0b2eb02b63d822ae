//! Built-in vehicles. Each is a TOML file that says where its values come from; the same form works
//! for files of one's own. The description and the sources of each are in
//! [`VehicleSpec::sources`](crate::VehicleSpec::sources).

use crate::error::Error;

const FILES: [(&str, &str); 8] = [
    ("b250e", include_str!("../vehicles/b250e.toml")),
    (
        "b250e-coast-down",
        include_str!("../vehicles/b250e-coast-down.toml"),
    ),
    ("bmw-i3-60ah", include_str!("../vehicles/bmw-i3-60ah.toml")),
    (
        "nissan-leaf-2013",
        include_str!("../vehicles/nissan-leaf-2013.toml"),
    ),
    (
        "renault-zoe-ze50",
        include_str!("../vehicles/renault-zoe-ze50.toml"),
    ),
    (
        "tesla-model-3-lr-2017",
        include_str!("../vehicles/tesla-model-3-lr-2017.toml"),
    ),
    (
        "vw-e-golf-2015",
        include_str!("../vehicles/vw-e-golf-2015.toml"),
    ),
    ("vw-id3", include_str!("../vehicles/vw-id3.toml")),
];

/// Names of the built-in vehicles, for [`Vehicle::builtin`](crate::Vehicle::builtin).
pub fn names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|&(name, _)| name)
}

pub(crate) fn text(name: &str) -> Result<&'static str, Error> {
    FILES
        .iter()
        .find(|(known, _)| *known == name)
        .map(|&(_, text)| text)
        .ok_or_else(|| Error::UnknownVehicle {
            name: name.to_owned(),
            known: names().collect::<Vec<_>>().join(", "),
        })
}
