//! The database: a GeoPackage, through sqlx, with the schema in `migrations/`.
