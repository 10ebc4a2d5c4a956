//! What the messages say that tell which streams there are.

use crate::ReadError;

/// The name of a stream with its instance.
pub(super) fn named(name: &str) -> String {
    match name.rsplit_once('.') {
        Some((_, instance)) if instance.parse::<u8>().is_ok() => name.to_owned(),
        _ => format!("{name}.0"),
    }
}

pub(super) fn topic_of(stream: &str) -> &str {
    stream.rsplit_once('.').map_or(stream, |(topic, _)| topic)
}

/// Number and stream of a subscription: instance, number, topic.
pub(super) fn subscription(body: &[u8]) -> Option<(u16, String)> {
    let (&[instance, low, high], topic) = body.split_first_chunk()?;
    let topic = std::str::from_utf8(topic).ok()?;
    let id = u16::from_le_bytes([low, high]);
    Some((id, format!("{topic}.{instance}")))
}

/// Number of the subscription and content of a data message.
pub(super) fn data(body: &[u8]) -> Option<(u16, &[u8])> {
    let (id, content) = body.split_first_chunk()?;
    Some((u16::from_le_bytes(*id), content))
}

/// Where data was appended. Flags that a reader has to know and that are not known are an error.
pub(super) fn appended(flags: &[u8]) -> Result<Vec<u64>, ReadError> {
    let incompatible = flags.get(8..16).unwrap_or_default();
    let [first, rest @ ..] = incompatible else {
        return Ok(Vec::new());
    };
    if first & !1 != 0 || rest.iter().any(|byte| *byte != 0) {
        return Err(ReadError::nameless("uses an unknown kind of ULog")
            .mend("its flags ask for a later reader"));
    }
    let offsets = flags.get(16..40).unwrap_or_default().chunks_exact(8);
    let offset = |bytes: &[u8]| bytes.first_chunk().map(|b| u64::from_le_bytes(*b));
    Ok(offsets.filter_map(offset).collect())
}
