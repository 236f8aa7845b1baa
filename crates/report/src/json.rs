//! JSON in which a number that is not finite is not silently lost.

use crate::error::ReportError;
use serde::ser::{self, Serialize, Serializer};

/// The value as indented JSON with a line end.
///
/// JSON has no NaN and no infinity, and `serde_json` writes `null` for them, which readers take for "not computed". Here they
/// become the strings `"NaN"`, `"inf"` and `"-inf"`, wherever they occur.
///
/// # Errors
///
/// [`ReportError::Json`] if the value cannot be JSON, such as a map whose keys are lists.
pub fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, ReportError> {
    let mut text = serde_json::to_string_pretty(&Honest(value))?;
    text.push('\n');
    Ok(text)
}

/// A value that is serialised through [`Named`].
struct Honest<'a, T: ?Sized>(&'a T);

impl<T: Serialize + ?Sized> Serialize for Honest<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(Named(serializer))
    }
}

/// A serializer, or the state of one within a list or an object, that names numbers which are not finite.
struct Named<S>(S);

macro_rules! forward {
    ($($method:ident($($argument:ident: $type:ty),*) -> $result:ty;)*) => {
        $(fn $method(self, $($argument: $type),*) -> Result<$result, S::Error> {
            self.0.$method($($argument),*)
        })*
    };
}

macro_rules! forward_compound {
    ($($method:ident($($argument:ident: $type:ty),*) -> $result:ident;)*) => {
        $(fn $method(self, $($argument: $type),*) -> Result<Self::$result, S::Error> {
            self.0.$method($($argument),*).map(Named)
        })*
    };
}

impl<S: Serializer> Serializer for Named<S> {
    type Ok = S::Ok;
    type Error = S::Error;
    type SerializeSeq = Named<S::SerializeSeq>;
    type SerializeTuple = Named<S::SerializeTuple>;
    type SerializeTupleStruct = Named<S::SerializeTupleStruct>;
    type SerializeTupleVariant = Named<S::SerializeTupleVariant>;
    type SerializeMap = Named<S::SerializeMap>;
    type SerializeStruct = Named<S::SerializeStruct>;
    type SerializeStructVariant = Named<S::SerializeStructVariant>;

    fn serialize_f64(self, v: f64) -> Result<S::Ok, S::Error> {
        match v {
            v if v.is_finite() => self.0.serialize_f64(v),
            v if v.is_nan() => self.0.serialize_str("NaN"),
            v if v > 0.0 => self.0.serialize_str("inf"),
            _ => self.0.serialize_str("-inf"),
        }
    }

    fn serialize_f32(self, v: f32) -> Result<S::Ok, S::Error> {
        // A finite one goes on as it is: widened, it would show digits it does not have.
        if v.is_finite() {
            self.0.serialize_f32(v)
        } else {
            self.serialize_f64(v.into())
        }
    }

    forward! {
        serialize_bool(v: bool) -> S::Ok;
        serialize_i8(v: i8) -> S::Ok;
        serialize_i16(v: i16) -> S::Ok;
        serialize_i32(v: i32) -> S::Ok;
        serialize_i64(v: i64) -> S::Ok;
        serialize_i128(v: i128) -> S::Ok;
        serialize_u8(v: u8) -> S::Ok;
        serialize_u16(v: u16) -> S::Ok;
        serialize_u32(v: u32) -> S::Ok;
        serialize_u64(v: u64) -> S::Ok;
        serialize_u128(v: u128) -> S::Ok;
        serialize_char(v: char) -> S::Ok;
        serialize_str(v: &str) -> S::Ok;
        serialize_bytes(v: &[u8]) -> S::Ok;
        serialize_none() -> S::Ok;
        serialize_unit() -> S::Ok;
        serialize_unit_struct(name: &'static str) -> S::Ok;
        serialize_unit_variant(name: &'static str, index: u32, variant: &'static str) -> S::Ok;
    }

    forward_compound! {
        serialize_seq(len: Option<usize>) -> SerializeSeq;
        serialize_tuple(len: usize) -> SerializeTuple;
        serialize_tuple_struct(name: &'static str, len: usize) -> SerializeTupleStruct;
        serialize_tuple_variant(name: &'static str, index: u32, variant: &'static str, len: usize) -> SerializeTupleVariant;
        serialize_map(len: Option<usize>) -> SerializeMap;
        serialize_struct(name: &'static str, len: usize) -> SerializeStruct;
        serialize_struct_variant(name: &'static str, index: u32, variant: &'static str, len: usize) -> SerializeStructVariant;
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<S::Ok, S::Error> {
        self.0.serialize_some(&Honest(value))
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        value: &T,
    ) -> Result<S::Ok, S::Error> {
        self.0.serialize_newtype_struct(name, &Honest(value))
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        name: &'static str,
        index: u32,
        variant: &'static str,
        value: &T,
    ) -> Result<S::Ok, S::Error> {
        self.0
            .serialize_newtype_variant(name, index, variant, &Honest(value))
    }

    fn is_human_readable(&self) -> bool {
        self.0.is_human_readable()
    }
}

/// Lists: one method that takes a value, and the end.
macro_rules! list {
    ($($kind:ident::$method:ident;)*) => {
        $(impl<S: ser::$kind> ser::$kind for Named<S> {
            type Ok = S::Ok;
            type Error = S::Error;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), S::Error> {
                self.0.$method(&Honest(value))
            }

            fn end(self) -> Result<S::Ok, S::Error> {
                self.0.end()
            }
        })*
    };
}

list! {
    SerializeSeq::serialize_element;
    SerializeTuple::serialize_element;
    SerializeTupleStruct::serialize_field;
    SerializeTupleVariant::serialize_field;
}

/// Objects with fields known by name.
macro_rules! object {
    ($($kind:ident),*) => {
        $(impl<S: ser::$kind> ser::$kind for Named<S> {
            type Ok = S::Ok;
            type Error = S::Error;

            fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), S::Error> {
                self.0.serialize_field(key, &Honest(value))
            }

            fn skip_field(&mut self, key: &'static str) -> Result<(), S::Error> {
                self.0.skip_field(key)
            }

            fn end(self) -> Result<S::Ok, S::Error> {
                self.0.end()
            }
        })*
    };
}

object!(SerializeStruct, SerializeStructVariant);

impl<S: ser::SerializeMap> ser::SerializeMap for Named<S> {
    type Ok = S::Ok;
    type Error = S::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), S::Error> {
        self.0.serialize_key(&Honest(key))
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), S::Error> {
        self.0.serialize_value(&Honest(value))
    }

    fn end(self) -> Result<S::Ok, S::Error> {
        self.0.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[derive(serde::Serialize)]
    enum Kind {
        Unit,
        New(f64),
        Tuple(f64, f32),
        Fields { a: Option<f64> },
    }

    #[derive(serde::Serialize)]
    struct Everything {
        list: Vec<f64>,
        none: Option<f64>,
        map: BTreeMap<String, (f64, u64)>,
        kinds: Vec<Kind>,
    }

    #[test]
    fn nothing_that_is_not_finite_becomes_null() {
        let value = Everything {
            list: vec![0.1, f64::NAN, f64::INFINITY, -f64::INFINITY],
            none: None,
            map: BTreeMap::from([("k".to_owned(), (f64::NAN, u64::MAX))]),
            kinds: vec![
                Kind::Unit,
                Kind::New(f64::NAN),
                Kind::Tuple(1.5, f32::INFINITY),
                Kind::Fields { a: Some(f64::NAN) },
            ],
        };
        let read: serde_json::Value = serde_json::from_str(&json(&value).unwrap()).unwrap();
        let wanted = serde_json::json!({
            "list": [0.1, "NaN", "inf", "-inf"],
            "none": null,
            "map": {"k": ["NaN", u64::MAX]},
            "kinds": ["Unit", {"New": "NaN"}, {"Tuple": [1.5, "inf"]}, {"Fields": {"a": "NaN"}}],
        });
        assert_eq!(read, wanted);
    }

    #[test]
    fn finite_values_are_written_as_serde_json_does() {
        let value = (vec![0.1_f64, 1e-300], 0.1_f32, "text", true, [1_u8, 2]);
        assert_eq!(
            json(&value).unwrap().trim_end(),
            serde_json::to_string_pretty(&value).unwrap()
        );
    }
}
