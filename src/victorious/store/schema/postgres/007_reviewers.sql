-- A review for each person: its key has its reviewer.

ALTER TABLE reviews DROP CONSTRAINT reviews_pkey;
ALTER TABLE reviews ADD PRIMARY KEY
  (video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px, reviewer);
