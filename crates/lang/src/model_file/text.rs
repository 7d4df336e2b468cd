//! Texts as arguments of kinds.

use moldloft_num::Real;
use moldloft_registry::{CallError, Class, FromValue, Value};
use std::marker::PhantomData;
use std::sync::Arc;

/// A text, in a kind that is generic over the number.
#[derive(Clone, Debug)]
pub struct Text<T>(Arc<str>, PhantomData<T>);

impl<T> Text<T> {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl<T: Real> FromValue<T> for Text<T> {
    const CLASS: Class = Class::Text;
    fn from_value(value: &Value<T>) -> Result<Self, CallError> {
        <Arc<str> as FromValue<T>>::from_value(value).map(|text| Text(text, PhantomData))
    }
}

impl<T: Real> Text<T> {
    /// The text as a value.
    pub fn into_value(self) -> Value<T> {
        Value::Text(self.0)
    }
}
