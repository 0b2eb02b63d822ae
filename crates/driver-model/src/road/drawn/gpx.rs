//! Tracks and routes of GPX (1.0 and 1.1): positions with elevations, nothing else.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::track::Track;

/// More points than this are refused, as are more entries of a road.
const MOST_POINTS: usize = 1_000_000;

/// What a GPX file holds.
#[derive(Default)]
pub(super) struct Gpx {
    /// Tracks, each in its segments.
    pub(super) tracks: Vec<Vec<Track>>,
    pub(super) routes: Vec<Track>,
}

/// The tracks and routes of a text, or what is wrong with it and where.
pub(super) fn read(text: &str) -> Result<Gpx, String> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut reading = Reading::default();
    loop {
        let event = reader.read_event();
        let step = match event {
            Ok(Event::Eof) => break,
            Ok(Event::Start(element)) => reading.start(&element),
            Ok(Event::End(_)) => reading.end(),
            Ok(Event::Text(text)) => {
                reading.text(&text.xml_content(XmlVersion::Implicit1_0));
                Ok(())
            }
            Ok(_) => Ok(()),
            Err(error) => Err(format!("no GPX: {error}")),
        };
        step.map_err(|reason| {
            let read = (reader.buffer_position() as usize).min(text.len());
            let line = text.as_bytes()[..read]
                .iter()
                .filter(|byte| **byte == b'\n')
                .count()
                + 1;
            format!("line {line}: {reason}")
        })?;
    }
    match reading.open.last() {
        Some(open) => Err(format!("cut off within <{open}>; give the whole file")),
        None if !reading.is_gpx => Err("no GPX: it has no <gpx>".to_owned()),
        None => Ok(reading.found),
    }
}

#[derive(Default)]
struct Reading {
    /// Names of the elements that are open.
    open: Vec<String>,
    is_gpx: bool,
    /// Whether points are of a route.
    in_route: bool,
    points: usize,
    elevation: String,
    found: Gpx,
}

impl Reading {
    fn start(&mut self, element: &BytesStart) -> Result<(), String> {
        let name = element.local_name();
        let name: &str = name.as_ref();
        let inside = self.open.last().map(String::as_str);
        match (name, inside) {
            ("gpx", None) => self.is_gpx = true,
            ("trk", Some("gpx")) => self.found.tracks.push(Vec::new()),
            ("trkseg", Some("trk")) => {
                let track = self.found.tracks.last_mut();
                track
                    .into_iter()
                    .for_each(|track| track.push(Track::default()));
            }
            ("rte", Some("gpx")) => self.found.routes.push(Track::default()),
            ("trkpt", Some("trkseg")) => self.point(element, false)?,
            ("rtept", Some("rte")) => self.point(element, true)?,
            ("ele", Some("trkpt" | "rtept")) => self.elevation.clear(),
            _ => {}
        }
        self.open.push(name.to_owned());
        Ok(())
    }

    fn text(&mut self, text: &str) {
        if self.is_elevation() {
            self.elevation += text;
        }
    }

    fn end(&mut self) -> Result<(), String> {
        if self.is_elevation() {
            let text = self.elevation.trim();
            let elevation_m = text.parse();
            let elevation_m: f64 = elevation_m
                .map_err(|_| format!("<ele> is `{text}`; give metres as a number, or no <ele>"))?;
            let last = self.line().and_then(|line| line.elevation_m.last_mut());
            last.into_iter().for_each(|last| *last = elevation_m);
        }
        self.open.pop();
        Ok(())
    }

    fn is_elevation(&self) -> bool {
        matches!(&self.open[..], [.., point, last] if last == "ele" && (point == "trkpt" || point == "rtept"))
    }

    /// The line that points go to.
    fn line(&mut self) -> Option<&mut Track> {
        match self.in_route {
            true => self.found.routes.last_mut(),
            false => self.found.tracks.last_mut()?.last_mut(),
        }
    }

    fn point(&mut self, element: &BytesStart, in_route: bool) -> Result<(), String> {
        self.in_route = in_route;
        self.points += 1;
        if self.points > MOST_POINTS {
            return Err(format!(
                "more than {MOST_POINTS} points; simplify the track"
            ));
        }
        let degrees = |key: &str, most: f64| -> Result<f64, String> {
            let value = element
                .try_get_attribute(key)
                .map_err(|error| error.to_string())?;
            let text = value.map(|attribute| attribute.value.trim().to_owned());
            let text = text.ok_or_else(|| format!("a point without {key}; give degrees"))?;
            let number = text
                .parse()
                .ok()
                .filter(|number: &f64| number.abs() <= most);
            number.ok_or_else(|| format!("{key} is `{text}`; give degrees from -{most} to {most}"))
        };
        let position_deg = [degrees("lon", 180.0)?, degrees("lat", 90.0)?];
        if let Some(line) = self.line() {
            line.positions_deg.push(position_deg);
            line.elevation_m.push(f64::NAN);
        }
        Ok(())
    }
}
