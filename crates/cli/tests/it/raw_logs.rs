//! Raw logs of drives, public and simulated, in the formats that can hold them and with the axes of the IMU turned:
//! nothing but `inspect` and `outages`.

/// Appends numbers, little-endian.
macro_rules! pack {
    ($out:expr; $($value:expr),*) => { { $( ($out).extend(($value).to_le_bytes()); )* } };
}
mod autopilots;
mod drives;
mod every_format;
mod every_turn;
mod live;
mod log;
mod matlab;
mod phones;
mod receivers;
mod robots;
mod tables;
mod unaided;
