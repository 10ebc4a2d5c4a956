//! The date of a log: UTC beside the time since the start of the system, in the receivers' messages.

use std::collections::HashMap;

use super::layout::{Field, Formats};
use super::messages::{Messages, NextMessage};
use super::subscriptions::{appended, data, subscription, topic_of};
use super::topics::kind_of;
use crate::entry::StreamKind;
use crate::epoch::{ClockSource, Epoch};
use crate::source::Source;

/// Messages that are looked at: of them, the one that came with the shortest delay counts.
const TIES: usize = 100;

/// What the times of a log count from, if a receiver knew UTC.
pub(super) fn epoch(source: Source) -> Option<Epoch> {
    let mut messages = Messages::open(source).ok()?;
    let (mut formats, mut clocks) = (Formats::default(), HashMap::<u16, [Field; 2]>::new());
    let mut ties = Vec::new();
    while ties.len() < TIES {
        let kind = match messages.step() {
            NextMessage::End(_) => break,
            NextMessage::Damaged(_) => continue,
            NextMessage::Message(kind) => kind,
        };
        let body = messages.body();
        match kind {
            b'B' => {
                let offsets = appended(body).ok()?;
                messages.set_appended(offsets.into_iter());
            }
            b'F' => {
                formats.define(body);
            }
            b'A' => {
                let Some((id, name)) = subscription(body) else {
                    continue;
                };
                let topic = topic_of(&name);
                let is_fix = kind_of(topic).0 == StreamKind::Fixes;
                let layout = formats.layout(topic).filter(|_| is_fix);
                let fields = layout.and_then(|layout| {
                    Some([layout.number("timestamp")?, layout.number("time_utc_usec")?])
                });
                clocks.extend(fields.map(|fields| (id, fields)));
            }
            b'D' => {
                let found = data(body).and_then(|(id, content)| Some((clocks.get(&id)?, content)));
                let Some((fields, content)) = found else {
                    continue;
                };
                let [own, utc] = fields.map(|field| field.read(content) / 1e6);
                ties.extend(Epoch::of_unix(utc, own, ClockSource::Gnss));
            }
            _ => {}
        }
    }
    let first = *ties.first()?;
    ties.into_iter()
        .max_by(|a, b| a.after(first).total_cmp(&b.after(first)))
}
