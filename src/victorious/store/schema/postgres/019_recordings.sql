-- Files of recorders, from which workers search the times of live sources that nobody searched as they came.

CREATE TABLE recordings (
  path        text PRIMARY KEY,
  source      text NOT NULL,
  from_utc_us bigint NOT NULL,
  to_utc_us   bigint NOT NULL,
  is_settled  boolean NOT NULL DEFAULT false
);
CREATE INDEX recordings_by_source ON recordings (source, from_utc_us);
