#include "victorious/search/recognize/recognize_options.h"

namespace victorious {

void RecognizeOptions::ListFields(FieldList& fields) {
  fields.Add(
      "method", method, kSearchMethodTexts,
      {.reason = "pose estimation from matches: grammar, the thesis's ratio test, cascade and MLESAC; votes, "
                 "Hough voting of ranked matches; shortlist, its fast approximation, which verifies only proposed "
                 "views; auto, shortlist for CAD models of 60 views or more, votes for those of fewer, and the grammar "
                 "for photos"});
  fields.AddGroup("search", search);
  fields.AddGroup("match", match);
  fields.AddGroup("cascade", cascade);
  fields.AddGroup("pose", pose);
  fields.AddGroup("detect", detect);
}

}  // namespace victorious
