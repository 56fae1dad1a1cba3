-- Names of tables and columns: a tracklet is what versions 2 to 4 called a run, a bearing what they called a line of
-- sight, and a column that holds the id of another table's row ends in _id. The content is unchanged.
-- docs/formats/index.md describes every table and column.

ALTER TABLE runs RENAME TO tracklets;
ALTER TABLE frame_features RENAME TO kept_frames;

-- The checksum of the model's content. Renamed first: model_id is the id of a row of models below.
ALTER TABLE models RENAME COLUMN model_id TO content_id;
ALTER TABLE videos RENAME COLUMN features_options TO features_options_id;

ALTER TABLE searches RENAME COLUMN video TO video_id;
ALTER TABLE searches RENAME COLUMN model TO model_id;
ALTER TABLE searches RENAME COLUMN options TO options_id;

ALTER TABLE tracklets RENAME COLUMN video TO video_id;
ALTER TABLE tracklets RENAME COLUMN model TO model_id;
ALTER TABLE tracklets RENAME COLUMN object TO object_id;

ALTER TABLE objects RENAME COLUMN model TO model_id;
ALTER TABLE objects RENAME COLUMN rejected TO rejection_reason;

ALTER TABLE sightings RENAME COLUMN video TO video_id;
ALTER TABLE sightings RENAME COLUMN run TO tracklet_id;
ALTER TABLE sightings RENAME COLUMN track TO track_id;
ALTER TABLE sightings RENAME COLUMN line_azimuth_rad TO bearing_azimuth_rad;
ALTER TABLE sightings RENAME COLUMN line_elevation_rad TO bearing_elevation_rad;
ALTER TABLE sightings RENAME COLUMN line_sigma_rad TO bearing_sigma_rad;

ALTER TABLE kept_frames RENAME COLUMN video TO video_id;

DROP INDEX runs_by_model;
DROP INDEX runs_by_video;
DROP INDEX runs_by_object;
DROP INDEX sightings_by_run;
CREATE INDEX tracklets_by_model ON tracklets (model_id, video_id);
CREATE INDEX tracklets_by_video ON tracklets (video_id);
CREATE INDEX tracklets_by_object ON tracklets (object_id);
CREATE INDEX sightings_by_tracklet ON sightings (tracklet_id);
