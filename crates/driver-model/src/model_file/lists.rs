//! JSON for people that stays short: the items of a list have a line each, whatever is in them.

use std::io::{Result, Write};

use serde_json::Serializer;
use serde_json::ser::{CompactFormatter, Formatter, PrettyFormatter};

/// Indented, but for what is inside of the items of a list.
#[derive(Default)]
pub(super) struct ItemsOnALine {
    pretty: PrettyFormatter<'static>,
    /// Open brackets from that of the list on.
    open: usize,
}

impl ItemsOnALine {
    pub(super) fn serializer<W: Write>(writer: W) -> Serializer<W, Self> {
        Serializer::with_formatter(writer, Self::default())
    }
}

impl Formatter for ItemsOnALine {
    fn begin_array<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.open += 1;
        match self.open {
            1 => self.pretty.begin_array(writer),
            _ => CompactFormatter.begin_array(writer),
        }
    }

    fn end_array<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        self.open -= 1;
        match self.open {
            0 => self.pretty.end_array(writer),
            _ => CompactFormatter.end_array(writer),
        }
    }

    fn begin_array_value<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> Result<()> {
        match self.open {
            1 => self.pretty.begin_array_value(writer, first),
            _ => CompactFormatter.begin_array_value(writer, first),
        }
    }

    fn end_array_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        match self.open {
            1 => self.pretty.end_array_value(writer),
            _ => CompactFormatter.end_array_value(writer),
        }
    }

    fn begin_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        if self.open == 0 {
            return self.pretty.begin_object(writer);
        }
        self.open += 1;
        CompactFormatter.begin_object(writer)
    }

    fn end_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        if self.open == 0 {
            return self.pretty.end_object(writer);
        }
        self.open -= 1;
        CompactFormatter.end_object(writer)
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> Result<()> {
        match self.open {
            0 => self.pretty.begin_object_key(writer, first),
            _ => CompactFormatter.begin_object_key(writer, first),
        }
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        match self.open {
            0 => self.pretty.begin_object_value(writer),
            _ => CompactFormatter.begin_object_value(writer),
        }
    }

    fn end_object_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> Result<()> {
        match self.open {
            0 => self.pretty.end_object_value(writer),
            _ => CompactFormatter.end_object_value(writer),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde::Serialize as _;
    use serde_json::json;

    use super::*;

    #[test]
    fn items_have_a_line_and_the_rest_is_indented() {
        let value =
            json!({"a": [], "b": {"c": [1, 2], "d": {}}, "e": [{"f": [[1], {}]}, null], "g": 1});
        let mut text = Vec::new();
        value
            .serialize(&mut ItemsOnALine::serializer(&mut text))
            .unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(
            text,
            "{\n  \"a\": [],\n  \"b\": {\n    \"c\": [\n      1,\n      2\n    ],\n    \"d\": {}\n  },\n  \"e\": [\n    \
             {\"f\":[[1],{}]},\n    null\n  ],\n  \"g\": 1\n}"
        );
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&text).unwrap(),
            value
        );
    }
}
