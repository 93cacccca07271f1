//! What happens in time: marching without harmonics.

pub mod marching;
