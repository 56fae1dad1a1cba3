-- What people say of the identity of tracklets, and the parameters of data association.

CREATE TABLE tracklet_links (
  id           bigint PRIMARY KEY,
  correction   bigint NOT NULL,
  is_one       bigint NOT NULL,
  author       text NOT NULL,
  made_utc_us  bigint NOT NULL
);

CREATE TABLE tracklet_link_ends (
  link_id          bigint NOT NULL REFERENCES tracklet_links (id) ON DELETE CASCADE,
  is_second        bigint NOT NULL,
  video_content_id text NOT NULL,
  model_name       text NOT NULL,
  frame            bigint NOT NULL,
  box_x_px         double precision NOT NULL,
  box_y_px         double precision NOT NULL,
  box_width_px     double precision NOT NULL,
  box_height_px    double precision NOT NULL,
  PRIMARY KEY (link_id, is_second)
);

CREATE TABLE association_options (
  id    bigint PRIMARY KEY CHECK (id = 1),
  json  text NOT NULL
);
