//! Conditions in CQL2's text form: comparisons with numbers and texts, BETWEEN, IN, LIKE, IS NULL, AND, OR, NOT, parentheses, TRUE, FALSE.
//!
//! An attribute stands on the left and a value of its kind on the right. An error names the place, by characters from 1.

use super::shortened;
use crate::store::{ComparisonSign, Literal, Predicate};

/// How deep parentheses and NOT may lie in each other.
const MOST_DEEP: usize = 32;

/// What an attribute can be asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AttributeKind {
    /// Numbers.
    Number,
    /// Texts; ids, too.
    Text,
}

/// An attribute that conditions may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Attribute {
    pub(super) name: &'static str,
    pub(super) kind: AttributeKind,
}

/// What is wrong with a condition, and where.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct FilterFault {
    /// The place, characters from 1.
    pub(super) at: usize,
    pub(super) what: String,
}

type Read<T> = Result<T, FilterFault>;

/// A word of the text with its place.
#[derive(Debug, Clone, PartialEq)]
enum Lexeme {
    /// A keyword, or the name of an attribute or function.
    Word(String),
    /// A name between double quotes.
    Name(String),
    Text(String),
    Number(f64),
    Sign(&'static str),
    End,
}

/// Reads a condition on these attributes.
pub(super) fn read(text: &str, attributes: &[Attribute]) -> Read<Predicate> {
    let words = lexemes(text)?;
    let mut parser = FilterParser { words: &words, next: 0, attributes, depth: 0 };
    let predicate = parser.any()?;
    match parser.peek() {
        Lexeme::End => Ok(predicate),
        other => Err(parser.fault(format!("{} does not belong here; join conditions by AND or OR", shown(other)))),
    }
}

fn shown(lexeme: &Lexeme) -> String {
    match lexeme {
        Lexeme::Word(word) => shortened(word),
        Lexeme::Name(name) => format!("\"{}\"", shortened(name)),
        Lexeme::Text(text) => format!("'{}'", shortened(text)),
        Lexeme::Number(number) => number.to_string(),
        Lexeme::Sign(sign) => format!("`{sign}`"),
        Lexeme::End => "the end".to_owned(),
    }
}

const SIGNS: [&str; 9] = ["<>", "<=", ">=", "<", ">", "=", "(", ")", ","];

fn lexemes(text: &str) -> Read<Vec<(usize, Lexeme)>> {
    let all: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(&first) = all.get(at) {
        let rest = &all[at..];
        let (length, lexeme) = if first.is_whitespace() {
            at += 1;
            continue;
        } else if first == '\'' {
            let (length, text) = quoted(rest, '\'').ok_or_else(|| fault(at, "this text has no closing quote"))?;
            (length, Lexeme::Text(text))
        } else if first == '"' {
            let (length, name) = quoted(rest, '"').ok_or_else(|| fault(at, "this name has no closing quote"))?;
            (length, Lexeme::Name(name))
        } else if first.is_alphabetic() || first == '_' {
            let part = |c: &&char| c.is_alphanumeric() || matches!(c, '_' | '.' | ':');
            let word: String = rest.iter().take_while(part).collect();
            (word.chars().count(), Lexeme::Word(word))
        } else if let Some((length, number)) = number(rest) {
            (length, Lexeme::Number(number.ok_or_else(|| fault(at, "this number cannot be read"))?))
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.iter().copied().take(sign.len()).eq(sign.chars()))
        {
            (sign.len(), Lexeme::Sign(sign))
        } else {
            return Err(fault(at, &format!("`{first}` is not understood")));
        };
        found.push((at, lexeme));
        at += length;
    }
    found.push((at, Lexeme::End));
    Ok(found)
}

fn fault(at: usize, what: &str) -> FilterFault {
    FilterFault { at: at + 1, what: what.to_owned() }
}

/// What stands between two quotes, and how many characters that takes. A quote inside is doubled, or follows a backslash; all other
/// backslashes stay.
fn quoted(rest: &[char], quote: char) -> Option<(usize, String)> {
    let (mut text, mut at) = (String::new(), 1);
    loop {
        match (rest.get(at)?, rest.get(at + 1)) {
            (&own, Some(&next)) if next == quote && (own == quote || own == '\\') => {
                text.push(quote);
                at += 2;
            }
            (&own, _) if own == quote => return Some((at + 1, text)),
            (&own, _) => {
                text.push(own);
                at += 1;
            }
        }
    }
}

/// A number with its length; `None` inside if it has the form of a number but is none, or is too large. `None` if there is no number.
fn number(rest: &[char]) -> Option<(usize, Option<f64>)> {
    let digits = rest.iter().skip(usize::from(matches!(rest.first(), Some('+' | '-'))));
    let mut first = digits.copied();
    let begins = match first.next()? {
        '.' => first.next()?.is_ascii_digit(),
        own => own.is_ascii_digit(),
    };
    if !begins {
        return None;
    }
    let mut text = String::new();
    for &c in rest {
        let sign = matches!(c, '+' | '-') && (text.is_empty() || text.ends_with(['e', 'E']));
        if !(sign || c.is_ascii_alphanumeric() || c == '.') {
            break;
        }
        text.push(c);
    }
    Some((text.len(), text.parse().ok().filter(|number: &f64| number.is_finite())))
}

struct FilterParser<'p> {
    words: &'p [(usize, Lexeme)],
    next: usize,
    attributes: &'p [Attribute],
    depth: usize,
}

impl<'p> FilterParser<'p> {
    fn peek(&self) -> &'p Lexeme {
        self.words.get(self.next).map_or(&Lexeme::End, |word| &word.1)
    }

    /// A fault at the next word.
    fn fault(&self, what: String) -> FilterFault {
        let at = self.words.get(self.next).or(self.words.last()).map_or(0, |word| word.0);
        FilterFault { at: at + 1, what }
    }

    /// Takes the next word if it is this keyword.
    fn keyword(&mut self, keyword: &str) -> bool {
        let is = matches!(self.peek(), Lexeme::Word(word) if word.eq_ignore_ascii_case(keyword));
        self.next += usize::from(is);
        is
    }

    fn sign(&mut self, wanted: &str) -> bool {
        let is = matches!(self.peek(), Lexeme::Sign(sign) if *sign == wanted);
        self.next += usize::from(is);
        is
    }

    fn needs_sign(&mut self, wanted: &str) -> Read<()> {
        if self.sign(wanted) {
            return Ok(());
        }
        Err(self.fault(format!("`{wanted}` is missing before {}", shown(self.peek()))))
    }

    fn any(&mut self) -> Read<Predicate> {
        let mut parts = vec![self.all()?];
        while self.keyword("OR") {
            parts.push(self.all()?);
        }
        Ok(one_or(parts, Predicate::Any))
    }

    fn all(&mut self) -> Read<Predicate> {
        let mut parts = vec![self.part()?];
        while self.keyword("AND") {
            parts.push(self.part()?);
        }
        Ok(one_or(parts, Predicate::All))
    }

    fn part(&mut self) -> Read<Predicate> {
        let begin = self.next;
        let not = self.keyword("NOT");
        if !not && !self.sign("(") {
            return self.predicate();
        }
        self.depth += 1;
        if self.depth > MOST_DEEP {
            self.next = begin;
            return Err(self.fault(format!("parentheses and NOT lie more than {MOST_DEEP} deep")));
        }
        let inner = if not { Predicate::Not(Box::new(self.part()?)) } else { self.any()? };
        if !not {
            self.needs_sign(")")?;
        }
        self.depth -= 1;
        Ok(inner)
    }

    fn predicate(&mut self) -> Read<Predicate> {
        if self.keyword("TRUE") {
            return Ok(Predicate::Constant(true));
        }
        if self.keyword("FALSE") {
            return Ok(Predicate::Constant(false));
        }
        let attribute = self.attribute()?;
        let column = attribute.name;
        if self.keyword("IS") {
            let not = self.keyword("NOT");
            if !self.keyword("NULL") {
                return Err(self.fault("NULL is missing after IS".to_owned()));
            }
            return Ok(negated(not, Predicate::NoValue(column)));
        }
        let not = self.keyword("NOT");
        if self.keyword("BETWEEN") {
            let low = self.literal(attribute)?;
            if !self.keyword("AND") {
                return Err(self.fault("AND is missing between the two values of BETWEEN".to_owned()));
            }
            let high = self.literal(attribute)?;
            return Ok(negated(not, Predicate::Between { column, low, high }));
        }
        if self.keyword("IN") {
            self.needs_sign("(")?;
            let mut values = vec![self.literal(attribute)?];
            while self.sign(",") {
                values.push(self.literal(attribute)?);
            }
            self.needs_sign(")")?;
            return Ok(negated(not, Predicate::OneOf { column, values }));
        }
        if self.keyword("LIKE") {
            if attribute.kind != AttributeKind::Text {
                return Err(self.fault(format!("LIKE asks for a text, and {column} is a number")));
            }
            let Literal::Text(pattern) = self.literal(attribute)? else {
                return Err(self.fault("LIKE needs a pattern in single quotes".to_owned()));
            };
            return Ok(negated(not, Predicate::Glob { column, pattern: glob(&pattern) }));
        }
        if not {
            return Err(self.fault("BETWEEN, IN or LIKE is missing after NOT".to_owned()));
        }
        let comparison = self.comparison(column)?;
        let value = self.literal(attribute)?;
        Ok(Predicate::Compare { column, comparison, value })
    }

    fn attribute(&mut self) -> Read<Attribute> {
        let (name, is_word) = match self.peek() {
            Lexeme::Word(word) => (word, true),
            Lexeme::Name(name) => (name, false),
            other => return Err(self.fault(format!("the name of an attribute is missing before {}", shown(other)))),
        };
        if let Some(&known) = self.attributes.iter().find(|attribute| attribute.name == name) {
            self.next += 1;
            return Ok(known);
        }
        let name = shortened(name);
        if is_word && matches!(self.words.get(self.next + 1), Some((_, Lexeme::Sign("(")))) {
            return Err(self.fault(format!("functions are not supported, {name} neither")));
        }
        let known: Vec<&str> = self.attributes.iter().map(|attribute| attribute.name).collect();
        Err(self.fault(format!("there is no attribute {name}; there are: {}", known.join(", "))))
    }

    fn comparison(&mut self, column: &str) -> Read<ComparisonSign> {
        let comparison = match self.peek() {
            Lexeme::Sign("=") => ComparisonSign::Equal,
            Lexeme::Sign("<>") => ComparisonSign::NotEqual,
            Lexeme::Sign("<") => ComparisonSign::Less,
            Lexeme::Sign("<=") => ComparisonSign::LessOrEqual,
            Lexeme::Sign(">") => ComparisonSign::Greater,
            Lexeme::Sign(">=") => ComparisonSign::GreaterOrEqual,
            other => {
                let what = format!(
                    "after {column} comes =, <>, <, <=, >, >=, BETWEEN, IN, LIKE or IS NULL, and not {}",
                    shown(other)
                );
                return Err(self.fault(what));
            }
        };
        self.next += 1;
        Ok(comparison)
    }

    /// A value of the attribute's kind.
    fn literal(&mut self, attribute: Attribute) -> Read<Literal> {
        let Attribute { name, kind } = attribute;
        let value = match (self.peek(), kind) {
            (Lexeme::Number(number), AttributeKind::Number) => Literal::Number(*number),
            (Lexeme::Text(text), AttributeKind::Text) => Literal::Text(text.clone()),
            (Lexeme::Number(_), AttributeKind::Text) => {
                return Err(self.fault(format!("{name} is a text: put its value between single quotes")));
            }
            (Lexeme::Text(_), AttributeKind::Number) => {
                return Err(self.fault(format!("{name} is a number: write its value without quotes")));
            }
            (other, _) => return Err(self.fault(format!("a value for {name} is missing before {}", shown(other)))),
        };
        self.next += 1;
        Ok(value)
    }
}

fn one_or(mut parts: Vec<Predicate>, joined: fn(Vec<Predicate>) -> Predicate) -> Predicate {
    match parts.pop() {
        Some(only) if parts.is_empty() => only,
        last => {
            parts.extend(last);
            joined(parts)
        }
    }
}

fn negated(not: bool, predicate: Predicate) -> Predicate {
    if not { Predicate::Not(Box::new(predicate)) } else { predicate }
}

/// The pattern of SQLite's `GLOB` for one of LIKE: `%` stands for any characters, `_` for one, and a backslash takes the meaning from the
/// character behind it.
fn glob(pattern: &str) -> String {
    let mut glob = String::new();
    let mut all = pattern.chars();
    while let Some(c) = all.next() {
        let plain = match c {
            '%' => {
                glob.push('*');
                continue;
            }
            '_' => {
                glob.push('?');
                continue;
            }
            '\\' => all.next().unwrap_or('\\'),
            c => c,
        };
        match plain {
            '*' | '?' | '[' => glob.extend(['[', plain, ']']),
            plain => glob.push(plain),
        }
    }
    glob
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn anything_is_read_or_refused_at_a_place_in_it(text in ".{0,60}") {
            if let Err(fault) = read(&text) {
                prop_assert!(1 <= fault.at && fault.at <= text.chars().count() + 1);
            }
        }

        #[test]
        fn any_order_of_words_is_read_or_refused_at_a_place_in_it(
            text in "(rsc_m |verdict |AND |OR |NOT |IN |LIKE |BETWEEN |IS |NULL |TRUE |\\(|\\)|,|=|<>|<|'a'|'|\"|-1.5|7 ){0,24}"
        ) {
            if let Err(fault) = read(&text) {
                prop_assert!(1 <= fault.at && fault.at <= text.chars().count() + 1);
            }
        }
    }

    const ATTRIBUTES: [Attribute; 3] = [
        Attribute { name: "rsc_m", kind: AttributeKind::Number },
        Attribute { name: "verdict", kind: AttributeKind::Text },
        Attribute { name: "edge_id", kind: AttributeKind::Text },
    ];

    fn read(text: &str) -> Read<Predicate> {
        super::read(text, &ATTRIBUTES)
    }

    fn more_than(number: f64) -> Predicate {
        let value = Literal::Number(number);
        Predicate::Compare { column: "rsc_m", comparison: ComparisonSign::Greater, value }
    }

    #[test]
    fn and_binds_closer_than_or_and_not_closer_than_both() {
        let [a, b, c] = [1.0, 2.0, 3.0].map(more_than);
        let both = Predicate::All(vec![Predicate::Not(Box::new(b.clone())), c.clone()]);
        assert_eq!(read("rsc_m > 1 or NOT rsc_m>2 And rsc_m > 3.0"), Ok(Predicate::Any(vec![a.clone(), both])));
        let either = Predicate::Any(vec![a, b]);
        assert_eq!(read("(rsc_m > 1 OR rsc_m > 2) AND rsc_m > 3"), Ok(Predicate::All(vec![either, c])));
    }

    #[test]
    fn every_predicate_is_read() {
        let text = |text: &str| Literal::Text(text.to_owned());
        let not = |predicate| Predicate::Not(Box::new(predicate));
        for (sign, comparison) in [
            ("=", ComparisonSign::Equal),
            ("<>", ComparisonSign::NotEqual),
            ("<", ComparisonSign::Less),
            ("<=", ComparisonSign::LessOrEqual),
            (">=", ComparisonSign::GreaterOrEqual),
        ] {
            let value = Literal::Number(-0.5);
            let expected = Predicate::Compare { column: "rsc_m", comparison, value };
            assert_eq!(read(&format!("rsc_m {sign} -0.5")), Ok(expected.clone()));
            assert_eq!(read(&format!("\"rsc_m\"{sign}-.5e0")), Ok(expected));
        }
        let between = Predicate::Between { column: "rsc_m", low: Literal::Number(0.0), high: Literal::Number(1.5) };
        assert_eq!(read("rsc_m BETWEEN 0 AND 1.5"), Ok(between.clone()));
        assert_eq!(read("rsc_m not between 0 and +1.5"), Ok(not(between)));
        let of = Predicate::OneOf { column: "verdict", values: vec![text("safe"), text("it's")] };
        assert_eq!(read("verdict IN ('safe','it''s')"), Ok(of.clone()));
        assert_eq!(read(r"verdict NOT IN ( 'safe', 'it\'s' )"), Ok(not(of)));
        let like = Predicate::Glob { column: "verdict", pattern: "*s?f[*]e%".to_owned() };
        assert_eq!(read(r"verdict LIKE '%s_f*e\%'"), Ok(like.clone()));
        assert_eq!(read(r"verdict NOT LIKE '%s_f*e\%'"), Ok(not(like)));
        assert_eq!(read("verdict IS NULL"), Ok(Predicate::NoValue("verdict")));
        assert_eq!(read("verdict IS NOT NULL"), Ok(not(Predicate::NoValue("verdict"))));
        assert_eq!(
            read("TRUE AND false"),
            Ok(Predicate::All(vec![Predicate::Constant(true), Predicate::Constant(false)]))
        );
        let nothing = Predicate::Compare { column: "verdict", comparison: ComparisonSign::Equal, value: text("") };
        assert_eq!(read("verdict=''"), Ok(nothing));
    }

    #[test]
    fn a_fault_names_its_place() {
        for (wrong, at, what) in [
            ("", 1, "attribute is missing"),
            ("rsc_m", 6, "after rsc_m"),
            ("rsc_m > ", 9, "value for rsc_m"),
            ("rsc_m > 'a'", 9, "is a number"),
            ("edge_id = 12", 11, "is a text"),
            ("nosuch = 1", 1, "there are: rsc_m, verdict, edge_id"),
            ("RSC_M = 1", 1, "no attribute RSC_M"),
            ("rsc_m = 1 verdict = 'safe'", 11, "AND or OR"),
            ("(rsc_m = 1", 11, "`)` is missing"),
            ("rsc_m = 1)", 10, "does not belong"),
            ("verdict = 'safe", 11, "no closing quote"),
            ("CASEI(verdict) = 'safe'", 1, "functions"),
            ("S_INTERSECTS(geometry, POINT(1 2))", 1, "functions"),
            ("rsc_m + 1 > 2", 7, "`+` is not understood"),
            ("rsc_m > 1e999", 9, "cannot be read"),
            ("rsc_m > 1.2.3", 9, "cannot be read"),
            ("rsc_m > 12abc", 9, "cannot be read"),
            ("rsc_m > rsc_m", 9, "value for rsc_m"),
            ("rsc_m LIKE '1'", 12, "is a number"),
            ("rsc_m BETWEEN 1 OR 2", 17, "AND is missing"),
            ("rsc_m IN ()", 11, "value for rsc_m"),
            ("rsc_m IS 1", 10, "NULL is missing"),
            ("verdict NOT = 'safe'", 13, "missing after NOT"),
            ("verdict = 'safe'; DROP TABLE edge", 17, "`;` is not understood"),
            ("ä = 1", 1, "no attribute ä"),
        ] {
            let fault = read(wrong).unwrap_err();
            assert!(fault.at == at && fault.what.contains(what), "{wrong:?}: {fault:?}");
        }
    }

    #[test]
    fn no_condition_is_too_deep_for_the_stack() {
        let deep = |depth: usize| format!("{}TRUE{}", "(".repeat(depth), ")".repeat(depth));
        assert!(read(&deep(MOST_DEEP)).is_ok());
        assert_eq!(read(&deep(MOST_DEEP + 1)).unwrap_err().at, MOST_DEEP + 1);
        assert!(read(&"NOT ".repeat(900)).is_err());
        assert!(read(&format!("{}TRUE", "TRUE OR ".repeat(240))).is_ok());
        assert!(read(&"((TRUE) AND (TRUE)) AND ".repeat(50)).is_err_and(|fault| fault.what.contains("attribute")));
    }
}
