-- What data association keeps from one run for the next.

-- Changes with the sightings of the tracklet.
ALTER TABLE tracklets ADD COLUMN revision bigint NOT NULL DEFAULT 0;

CREATE TABLE kept_fits (
  tracklet_id bigint NOT NULL REFERENCES tracklets (id) ON DELETE CASCADE,
  key         bigint NOT NULL,
  fit         bytea NOT NULL,
  path        bytea,
  PRIMARY KEY (tracklet_id, key)
);
