-- What was an object, a run of sightings in one video, becomes a run; objects are runs joined by identity and place.
-- docs/formats/index.md describes every table and column.

ALTER TABLE objects RENAME TO runs;
ALTER TABLE sightings RENAME COLUMN object TO run;

DROP INDEX objects_by_model;
DROP INDEX objects_by_video;
DROP INDEX sightings_by_object;
CREATE INDEX runs_by_model ON runs (model, video);
CREATE INDEX runs_by_video ON runs (video);
CREATE INDEX sightings_by_run ON sightings (run);

-- An object's id is that of its first run.
CREATE TABLE objects (
  id                     INTEGER PRIMARY KEY,
  model                  INTEGER NOT NULL REFERENCES models (id) ON DELETE CASCADE,
  place_time_s           REAL,
  latitude_rad           REAL,
  longitude_rad          REAL,
  altitude_m             REAL,
  covariance_enu_m2      BLOB,
  ce90_m                 REAL,
  le90_m                 REAL,
  velocity_enu_m_s       BLOB,
  velocity_covariance    BLOB,
  heading_rad            REAL,
  rejected               TEXT
) STRICT;
CREATE INDEX objects_by_model ON objects (model);

ALTER TABLE runs ADD COLUMN object INTEGER REFERENCES objects (id) ON DELETE SET NULL;
INSERT INTO objects (id, model) SELECT id, model FROM runs;
UPDATE runs SET object = id;
CREATE INDEX runs_by_object ON runs (object);

ALTER TABLE sightings ADD COLUMN camera_latitude_rad REAL;
ALTER TABLE sightings ADD COLUMN camera_longitude_rad REAL;
ALTER TABLE sightings ADD COLUMN camera_altitude_m REAL;
ALTER TABLE sightings ADD COLUMN camera_sigma_m REAL;
ALTER TABLE sightings ADD COLUMN camera_sigma_rad REAL;
ALTER TABLE sightings ADD COLUMN line_azimuth_rad REAL;
ALTER TABLE sightings ADD COLUMN line_elevation_rad REAL;
ALTER TABLE sightings ADD COLUMN line_sigma_rad REAL;
ALTER TABLE sightings ADD COLUMN range_m REAL;
ALTER TABLE sightings ADD COLUMN range_sigma_m REAL;
ALTER TABLE sightings ADD COLUMN heading_rad REAL;

-- Of the first frame, where telemetry tells.
ALTER TABLE videos ADD COLUMN start_utc_us INTEGER;
