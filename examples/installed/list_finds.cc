// list_finds VIDEO MODELS INDEX: searches a video for every model of a folder, and prints what was found where, best
// first: model, score, and latitude, longitude, CE90 of its place. Uses the installed library alone.
#include <cstdio>

#include <victorious/victorious.h>

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: list_finds VIDEO MODELS INDEX\n");
    return 2;
  }
  try {
    libvictorious::Indexer indexer(libvictorious::ModelLibrary(argv[2]).LoadAll());
    indexer.Index(argv[1], argv[3]);
    for (const libvictorious::Object& object : libvictorious::Index(argv[3]).Objects()) {
      std::printf("%s %.4f", object.model.c_str(), object.score);
      if (object.place) {
        std::printf(" %.9f %.9f %.3f", object.place->latitude_deg, object.place->longitude_deg, object.place->ce90_m);
      }
      std::printf("\n");
    }
  } catch (const libvictorious::Error& error) {
    std::fprintf(stderr, "list_finds: %s\n", error.what());
    return 1;
  }
  return 0;
}
