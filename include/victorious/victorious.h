// All of the library.
#pragma once

#include <victorious/error.h>
#include <victorious/image.h>
#include <victorious/index.h>
#include <victorious/indexer.h>
#include <victorious/model.h>
#include <victorious/progress.h>
#include <victorious/recognizer.h>
#include <victorious/tracker.h>
#include <victorious/version.h>
#include <victorious/video.h>
