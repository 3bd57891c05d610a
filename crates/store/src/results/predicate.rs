//! Conditions on the columns of a feature, and their SQL. Values are always bound; no text of a condition becomes SQL.

use sqlx::Arguments as _;
use sqlx::sqlite::SqliteArguments;

type Sql<T> = Result<T, sqlx::Error>;

/// A condition on columns. It has three values, as in SQL: a comparison with a column that has no value is neither true nor false, and a
/// feature is found only where the whole condition is true.
#[derive(Debug, Clone, PartialEq)]
pub enum Predicate {
    /// All of them.
    All(Vec<Self>),
    /// At least one of them.
    Any(Vec<Self>),
    /// The contrary.
    Not(Box<Self>),
    /// Always true, or never.
    Constant(bool),
    /// A column compared with a value of its kind.
    Compare {
        /// Name of the column.
        column: &'static str,
        /// How they compare.
        comparison: ComparisonSign,
        /// The value.
        value: Literal,
    },
    /// A column from `low` to `high`, both included.
    Between {
        /// Name of the column.
        column: &'static str,
        /// The least value.
        low: Literal,
        /// The greatest value.
        high: Literal,
    },
    /// A column with one of these values.
    OneOf {
        /// Name of the column.
        column: &'static str,
        /// The values.
        values: Vec<Literal>,
    },
    /// A column whose whole text fits a pattern of SQLite's `GLOB`, which tells capitals from small letters.
    Glob {
        /// Name of the column.
        column: &'static str,
        /// The pattern.
        pattern: String,
    },
    /// A column without a value.
    NoValue(&'static str),
}

/// How a column compares with a value. Texts compare by their code points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ComparisonSign {
    Equal,
    NotEqual,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
}

impl ComparisonSign {
    fn sql(self) -> &'static str {
        match self {
            Self::Equal => "=",
            Self::NotEqual => "<>",
            Self::Less => "<",
            Self::LessOrEqual => "<=",
            Self::Greater => ">",
            Self::GreaterOrEqual => ">=",
        }
    }
}

/// A value of a condition. Ids are texts, because readers of JSON round numbers of 63 bits.
#[derive(Debug, Clone, PartialEq)]
pub enum Literal {
    /// A finite number.
    Number(f64),
    /// A text.
    Text(String),
}

/// What stands for a column in SQL.
pub(crate) struct ColumnSql {
    /// The expression.
    pub(crate) sql: String,
    /// Whether the column is an id: a whole number in the file, a text to clients.
    pub(crate) is_id: bool,
}

/// A statement that is being put together, with the values of its `?` in their order.
pub(crate) struct BoundSql {
    pub(crate) sql: String,
    pub(crate) values: SqliteArguments,
}

impl BoundSql {
    pub(crate) fn new(sql: String) -> Self {
        Self { sql, values: SqliteArguments::default() }
    }

    pub(crate) fn whole(&mut self, value: i64) -> Sql<()> {
        self.values.add(value).map_err(sqlx::Error::Encode)
    }

    pub(crate) fn number(&mut self, value: f64) -> Sql<()> {
        self.values.add(value).map_err(sqlx::Error::Encode)
    }

    fn text(&mut self, value: &str) -> Sql<()> {
        self.values.add(value.to_owned()).map_err(sqlx::Error::Encode)
    }

    fn literal(&mut self, value: &Literal) -> Sql<()> {
        match value {
            Literal::Number(number) => self.number(*number),
            Literal::Text(text) => self.text(text),
        }
    }

    /// Adds a condition. `column_of` returns what stands for a column; a column that it does not know is an error.
    pub(crate) fn condition(
        &mut self,
        predicate: &Predicate,
        column_of: &dyn Fn(&str) -> Option<ColumnSql>,
    ) -> Sql<()> {
        let found = |name: &str| column_of(name).ok_or_else(|| sqlx::Error::ColumnNotFound(name.to_owned()));
        match predicate {
            Predicate::All(parts) => self.joined(parts, " AND ", column_of)?,
            Predicate::Any(parts) => self.joined(parts, " OR ", column_of)?,
            Predicate::Not(part) => {
                self.sql.push_str("(NOT ");
                self.condition(part, column_of)?;
                self.sql.push(')');
            }
            Predicate::Constant(holds) => self.sql.push_str(if *holds { "(1)" } else { "(0)" }),
            Predicate::Compare { column, comparison, value } => self.compared(&found(column)?, *comparison, value)?,
            Predicate::Between { column, low, high } => {
                let text = as_text(&found(column)?);
                self.sql.push_str(&format!("({text} BETWEEN ? AND ?)"));
                self.literal(low)?;
                self.literal(high)?;
            }
            Predicate::OneOf { column, values } => self.one_of(&found(column)?, values)?,
            Predicate::Glob { column, pattern } => {
                let text = as_text(&found(column)?);
                self.sql.push_str(&format!("({text} GLOB ?)"));
                self.text(pattern)?;
            }
            Predicate::NoValue(column) => self.sql.push_str(&format!("({} IS NULL)", found(column)?.sql)),
        }
        Ok(())
    }

    fn joined(&mut self, parts: &[Predicate], between: &str, column_of: &dyn Fn(&str) -> Option<ColumnSql>) -> Sql<()> {
        self.sql.push('(');
        for (i, part) in parts.iter().enumerate() {
            self.sql.push_str(if i > 0 { between } else { "" });
            self.condition(part, column_of)?;
        }
        self.sql.push(')');
        Ok(())
    }

    /// An id that is compared with the text of a whole number is looked up as a number, through its index.
    fn compared(&mut self, column: &ColumnSql, comparison: ComparisonSign, value: &Literal) -> Sql<()> {
        let (same, sign) = (comparison == ComparisonSign::Equal, comparison.sql());
        if let Some(id) = id_of(column, value).filter(|_| same) {
            self.sql.push_str(&format!("({} {sign} ?)", column.sql));
            return self.whole(id);
        }
        self.sql.push_str(&format!("({} {sign} ?)", as_text(column)));
        self.literal(value)
    }

    fn one_of(&mut self, column: &ColumnSql, values: &[Literal]) -> Sql<()> {
        let marks = vec!["?"; values.len()].join(", ");
        let ids: Option<Vec<i64>> = values.iter().map(|value| id_of(column, value)).collect();
        if let Some(ids) = ids {
            self.sql.push_str(&format!("({} IN ({marks}))", column.sql));
            return ids.into_iter().try_for_each(|id| self.whole(id));
        }
        self.sql.push_str(&format!("({} IN ({marks}))", as_text(column)));
        values.iter().try_for_each(|value| self.literal(value))
    }
}

/// The id that a value is the text of; `None` if the column is no id, or if no id is written so.
fn id_of(column: &ColumnSql, value: &Literal) -> Option<i64> {
    match value {
        Literal::Text(text) if column.is_id => text.parse().ok().filter(|id: &i64| id.to_string() == *text),
        _ => None,
    }
}

/// The column as clients see it.
fn as_text(column: &ColumnSql) -> String {
    if column.is_id { format!("CAST({} AS TEXT)", column.sql) } else { column.sql.clone() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn sql_of(predicate: &Predicate) -> Sql<String> {
        let column = |name: &str| match name {
            "edge_id" => Some(ColumnSql { sql: "e.edge_id".to_owned(), is_id: true }),
            "rsc_m" => Some(ColumnSql { sql: "c.rsc_m".to_owned(), is_id: false }),
            _ => None,
        };
        let mut asked = BoundSql::new(String::new());
        asked.condition(predicate, &column)?;
        Ok(asked.sql)
    }

    #[test]
    fn values_are_bound_and_ids_are_texts_unless_they_are_looked_up() {
        let text = |text: &str| Literal::Text(text.to_owned());
        let id = |comparison, value| Predicate::Compare { column: "edge_id", comparison, value };
        assert_eq!(sql_of(&id(ComparisonSign::Equal, text("12"))).unwrap(), "(e.edge_id = ?)");
        for other in ["012", "+12", "12 ", "x", "9223372036854775808"] {
            assert_eq!(
                sql_of(&id(ComparisonSign::Equal, text(other))).unwrap(),
                "(CAST(e.edge_id AS TEXT) = ?)",
                "{other}"
            );
        }
        assert_eq!(sql_of(&id(ComparisonSign::Less, text("12"))).unwrap(), "(CAST(e.edge_id AS TEXT) < ?)");
        let low = Predicate::Between { column: "rsc_m", low: Literal::Number(0.0), high: Literal::Number(1.0) };
        let both = Predicate::All(vec![Predicate::Not(Box::new(low)), Predicate::NoValue("rsc_m")]);
        assert_eq!(sql_of(&both).unwrap(), "((NOT (c.rsc_m BETWEEN ? AND ?)) AND (c.rsc_m IS NULL))");
        let of = Predicate::OneOf { column: "edge_id", values: vec![text("1"), text("';--")] };
        assert_eq!(sql_of(&of).unwrap(), "(CAST(e.edge_id AS TEXT) IN (?, ?))");
        let of = Predicate::OneOf { column: "edge_id", values: vec![text("1"), text("-2")] };
        assert_eq!(sql_of(&of).unwrap(), "(e.edge_id IN (?, ?))");
        assert!(sql_of(&Predicate::NoValue("name; DROP TABLE edge")).is_err());
    }
}
