//! Warnings of a reader: one sentence per kind, with how often and where first.

use std::borrow::Cow;

/// More kinds than this are summed up in one sentence, so that a hostile file cannot fill memory with warnings.
const MAX_KINDS: usize = 24;

/// Warnings collected while reading.
#[derive(Debug, Default)]
pub(super) struct Notes {
    entries: Vec<Entry>,
    further: usize,
}

#[derive(Debug)]
struct Entry {
    what: Cow<'static, str>,
    count: usize,
    first: Option<usize>,
}

impl Notes {
    /// Counts one more of `what`, seen at a byte of the file.
    pub(super) fn at(&mut self, what: impl Into<Cow<'static, str>>, offset: usize) {
        self.count(what.into(), 1, Some(offset));
    }

    /// Counts `count` more of `what`, at no particular place.
    pub(super) fn add(&mut self, what: impl Into<Cow<'static, str>>, count: usize) {
        if count > 0 {
            self.count(what.into(), count, None);
        }
    }

    /// A sentence of its own.
    pub(super) fn say(&mut self, sentence: impl Into<Cow<'static, str>>) {
        self.count(sentence.into(), 0, None);
    }

    /// Appends the notes of a later part of the file.
    pub(super) fn append(&mut self, later: Self) {
        for entry in later.entries {
            self.count(entry.what, entry.count, entry.first);
        }
        self.further += later.further;
    }

    fn count(&mut self, what: Cow<'static, str>, count: usize, first: Option<usize>) {
        match self.entries.iter().position(|entry| entry.what == what) {
            Some(known) => {
                let entry = &mut self.entries[known];
                entry.count += count;
                entry.first = entry.first.or(first);
            }
            None if self.entries.len() < MAX_KINDS => self.entries.push(Entry { what, count, first }),
            None => self.further += 1,
        }
    }

    /// The sentences; `place` names a byte of the file ("line 12").
    pub(super) fn into_warnings(self, place: impl Fn(usize) -> String) -> Vec<String> {
        let mut warnings: Vec<String> = self
            .entries
            .into_iter()
            .map(|Entry { what, count, first }| match (count, first) {
                (0, _) => what.into_owned(),
                (_, None) => format!("{what} ({count} in all)"),
                (1, Some(offset)) => format!("{what} ({})", place(offset)),
                (_, Some(offset)) => format!("{what} ({count} in all, first at {})", place(offset)),
            })
            .collect();
        if self.further > 0 {
            warnings.push(format!("{} further warnings are not listed", self.further));
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_counted_and_bounded() {
        let mut notes = Notes::default();
        notes.at("point ignored", 7);
        let mut later = Notes::default();
        later.at("point ignored", 30);
        later.at("line ignored", 31);
        later.say("no colours");
        later.add("triangle dropped", 3);
        notes.append(later);
        for i in 0..100 {
            notes.say(format!("kind {i}"));
        }
        let warnings = notes.into_warnings(|offset| format!("byte {offset}"));
        assert_eq!(warnings[0], "point ignored (2 in all, first at byte 7)");
        assert_eq!(warnings[1], "line ignored (byte 31)");
        assert_eq!(warnings[2], "no colours");
        assert_eq!(warnings[3], "triangle dropped (3 in all)");
        assert_eq!(warnings.len(), MAX_KINDS + 1);
        assert_eq!(warnings[MAX_KINDS], "80 further warnings are not listed");
    }
}
