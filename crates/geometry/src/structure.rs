//! From the description of a mechanism to the order in which its positions are found: joints as pins, slides, welds
//! and couplings ([`lower`]), bodies that turn together ([`frames`]), the spanning tree and the loops that the other
//! joints close ([`tree`]), couplings on frames and slides ([`coupling`]), and the Assur groups ([`groups`]).

pub mod coupling;
pub mod frames;
pub mod groups;
pub mod lower;
pub mod tree;
