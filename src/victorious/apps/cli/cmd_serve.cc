// victorious serve --db FILE|URL: the triage page and its API
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <sys/stat.h>

#include "victorious/apps/cli/arguments.h"
#include "victorious/apps/cli/command.h"
#include "victorious/apps/cli/sample_files.h"
#include "victorious/apps/serve/api.h"
#include "victorious/apps/serve/base_map.h"
#include "victorious/apps/serve/http_server.h"
#include "victorious/base/absolute_path.h"
#include "victorious/base/log.h"
#include "victorious/base/missing_path.h"
#include "victorious/category/finder/category_source.h"
#include "victorious/store/open_store.h"

namespace victorious::cli {
namespace {

struct ServeArguments {
  std::string db;  ///< empty: kDefaultIndex
  bool is_created = false;
  std::string models;
  std::string categories;
  std::string listen = "127.0.0.1:8080";
  std::string telemetry;
  std::string web;
  std::string tiles;
  std::string tiles_attribution;
  std::string uploads;
  std::string copies;
  std::vector<std::string> videos;
  std::string tls_certificate;
  std::string tls_key;
  std::string access_log;
  double max_upload_gb = 50;
  int max_uploads = 2000;
  int max_jobs = 500;
  int upload_expiry_h = 24;
  std::vector<std::string> live_sources;
  double max_copies_gb = 20;
};

// The built page: beside the program in a build folder, or where a package installs it.
std::filesystem::path FindPage() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* relative : {"web", "../share/victorious/web"}) {
    if (std::filesystem::exists(program / relative / "index.html", error)) return program / relative;
  }
  return {};
}

constexpr const char* kDefaultIndex = "victorious.db";

// Makes an empty index where there is none, if that was asked for: a name that is mistyped is not an index.
// @return whether it was made
Expected<bool> MakeIndex(const ServeArguments& arguments, const std::string& name) {
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_index, HasIndex(name));
  if (has_index) return false;
  if (!arguments.db.empty() && !arguments.is_created) {
    if (IsDatabaseUrl(name)) return false;  // opening it says what it lacks
    return std::unexpected(
        NoSuchFile(name, "give an index that `victorious index` makes, or --create for a new one without videos"));
  }
  VICTORIOUS_RETURN_IF_ERROR(OpenStore(name, StoreMode::kCreate));
  LogInfo("{}: made, without videos", StoreName(name));
  return true;
}

// The library that is given, else the folder "models" beside the index: if it is there, or the index is new. Empty: the
// server takes no files.
Expected<std::filesystem::path> FindModels(const ServeArguments& arguments, const std::string& index, bool is_new) {
  if (!arguments.models.empty() || IsDatabaseUrl(index)) return arguments.models;
  std::error_code error;
  const std::filesystem::path file = std::filesystem::absolute(index, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), index));
  const std::filesystem::path beside = file.parent_path() / "models";
  if (is_new) std::filesystem::create_directories(beside, error);
  if (error) return std::unexpected(ErrorFromErrno(error.value(), beside.string()));
  return std::filesystem::is_directory(beside, error) ? beside : std::filesystem::path();
}

// What the names of the folders of uploads and copies begin with: that of a file, or of a database in the present
// folder. Absolute, because the index keeps it.
std::string FilesBeside(const std::string& db) {
  if (!IsDatabaseUrl(db)) return db;
  const std::string name = StoreName(db);
  const std::string database = name.substr(name.rfind('/', name.find('?')) + 1);
  std::error_code error;
  return std::filesystem::absolute(database.substr(0, database.find('?')), error).string();
}

Status CheckFolders(const std::vector<std::string>& folders) {
  for (const std::string& folder : folders) {
    const Status status = CheckIsFolder(folder, "give one that holds videos of the index");
    if (!status) return Fail(ErrorCode::kInvalidArgument, "--videos " + status.error().message);
  }
  return {};
}

Status Run(const ServeArguments& arguments) {
  VICTORIOUS_ASSIGN_OR_RETURN(HttpServerOptions server_options, ParseListenAddress(arguments.listen));
  server_options.tls_certificate = arguments.tls_certificate;
  server_options.tls_key = arguments.tls_key;
  const bool has_tls = !arguments.tls_certificate.empty();
  const StoreAddress address = TakePassword(arguments.db.empty() ? kDefaultIndex : arguments.db);
  // For this process and those of its jobs.
  if (!address.password.empty()) ::setenv("PGPASSWORD", address.password.c_str(), 1);
  const std::string beside = FilesBeside(address.name);
  ApiOptions options{.index = address.name, .models = {}, .telemetry = {}, .web = arguments.web};
  options.sample = FindSample();
  options.server = {.is_loopback = server_options.is_loopback, .has_tls = has_tls};
  options.uploads = arguments.uploads.empty() ? beside + ".uploads" : arguments.uploads;
  options.copies = arguments.copies.empty() ? beside + ".copies" : arguments.copies;
  VICTORIOUS_RETURN_IF_ERROR(CheckFolders(arguments.videos));
  options.videos.assign(arguments.videos.begin(), arguments.videos.end());
  options.access_log = arguments.access_log;
  options.secrets = {arguments.tls_key, arguments.tls_certificate};
  options.max_upload_bytes = static_cast<std::uint64_t>(arguments.max_upload_gb * 1e9);
  options.max_uploads = static_cast<std::size_t>(arguments.max_uploads);
  options.max_jobs = static_cast<std::size_t>(arguments.max_jobs);
  options.upload_expiry = std::chrono::hours(arguments.upload_expiry_h);
  options.live_sources = arguments.live_sources;
  options.max_copies_bytes = static_cast<std::uint64_t>(arguments.max_copies_gb * 1e9);
  if (!arguments.telemetry.empty()) options.telemetry = arguments.telemetry;
  if (!arguments.tiles.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(options.base_map, ReadBaseMap(arguments.tiles, arguments.tiles_attribution));
    server_options.tile_origin = options.base_map.origin;
  }
  if (!arguments.categories.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN([[maybe_unused]] const CategorySourceModel categories,
                                ReadCategorySource(arguments.categories));
    options.categories = AbsolutePath(arguments.categories);
  }
  std::error_code error;
  if (options.web.empty()) {
    options.web = FindPage();
    if (options.web.empty()) LogWarning("the page is not built, only the API is served: `make build` builds it");
  } else if (!std::filesystem::exists(options.web / "index.html", error)) {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: has no index.html: give the folder of the built page "
                                                  "(`make build` writes it to build/web)",
                                                  arguments.web));
  }
  // Uploads, copies and models that are added are of those who may log in: other users of the machine cannot read them,
  // its group can.
  ::umask(::umask(0) | 0027);
  VICTORIOUS_ASSIGN_OR_RETURN(const bool is_new, MakeIndex(arguments, address.name));
  VICTORIOUS_ASSIGN_OR_RETURN(options.models, FindModels(arguments, address.name, is_new));
  const CancelToken& interrupt = Interrupt();
  VICTORIOUS_ASSIGN_OR_RETURN(const std::unique_ptr<Api> api, Api::Open(std::move(options), interrupt));
  VICTORIOUS_ASSIGN_OR_RETURN(
      const std::unique_ptr<HttpServer> server,
      HttpServer::Listen(
          server_options, [&](const HttpRequest& request, int port) { return api->Begin(request, port); },
          [&](const HttpRequest& request, int port) { return api->PlanUpload(request, port); }));
  if (!server_options.is_loopback && !has_tls) {
    LogWarning("passwords and videos go through the network unencrypted: give --tls-cert and --tls-key");
  }
  const bool is_ipv6 = server_options.address.find(':') != std::string::npos;
  VICTORIOUS_RETURN_IF_ERROR(WriteOutput(
      "", fmt::format("{}://{}:{}/\n", has_tls ? "https" : "http",
                      is_ipv6 ? "[" + server_options.address + "]" : server_options.address, server->port())));
  std::fflush(stdout);
  LogInfo("open this address in a browser; Ctrl-C ends the server");
  server->Run(interrupt);
  return {};
}

}  // namespace

Action SetUpServe(ArgumentParser& parser) {
  const auto arguments = std::make_shared<ServeArguments>();
  parser
      .Add("--db", arguments->db,
           "The index: a file, or postgresql://USER@HOST/DATABASE (default: victorious.db in the present folder, which "
           "is made if it is not there)")
      .TypeName("DB");
  parser.AddFlag("--create", arguments->is_created, "Make the index if it is not there, without videos");
  parser
      .Add("--models", arguments->models,
           "Model library: shows the view that matched beside a sighting, and takes new models (default: the folder "
           "models beside the file of the index, which is made with a new index)")
      .TypeName("DIR");
  parser
      .Add("--categories", arguments->categories,
           "Category model or imported detector: videos that are added are searched for its categories, too, and "
           "reviews refine a model")
      .TypeName("FILE");
  parser
      .Add("--listen", arguments->listen,
           "Address and port; port 0: any free one. An address that is not a loopback address needs accounts "
           "(`victorious user`)")
      .ShowDefault()
      .TypeName("ADDRESS:PORT");
  Argument certificate =
      parser.Add("--tls-cert", arguments->tls_certificate, "Certificate of the server (PEM), with its issuers")
          .TypeName("FILE");
  Argument key = parser.Add("--tls-key", arguments->tls_key, "Its private key (PEM, not encrypted)").TypeName("FILE");
  certificate.Needs(key);
  key.Needs(certificate);
  parser
      .Add("--telemetry", arguments->telemetry,
           "Telemetry of the index's only video (default: in the video or beside it)")
      .TypeName("FILE");
  parser
      .Add(
          "--videos", arguments->videos,
          "Folder with videos of the index and their telemetry; repeatable. Files that the index names are opened only "
          "below these folders, the index's, the present one, and those of uploads and copies")
      .TypeName("DIR")
      .OneValueEach();
  parser
      .Add("--uploads", arguments->uploads,
           "Folder for uploaded videos and models (default: FILE.uploads, or DATABASE.uploads in the present folder)")
      .TypeName("DIR");
  parser
      .Add("--copies", arguments->copies,
           "Folder for copies of videos and for clips (default: FILE.copies, or DATABASE.copies in the present folder)")
      .TypeName("DIR");
  parser.Add("--max-upload", arguments->max_upload_gb, "Largest file that is taken, in GB")
      .ShowDefault()
      .Range(0.001, 100'000.0)
      .TypeName("GB");
  parser
      .Add("--max-uploads", arguments->max_uploads,
           "Uploads that no job has named yet, of all accounts; one may have a fifth of them")
      .ShowDefault()
      .Range(1, 1'000'000)
      .TypeName("N");
  parser
      .Add("--upload-expiry", arguments->upload_expiry_h,
           "Hours after which an upload that no job has named is removed, with the next upload")
      .ShowDefault()
      .Range(1, 100'000)
      .TypeName("HOURS");
  parser.Add("--max-jobs", arguments->max_jobs, "Jobs that are open, of all accounts; one may have a fifth of them")
      .ShowDefault()
      .Range(1, 1'000'000)
      .TypeName("N");
  parser
      .Add("--live-sources", arguments->live_sources,
           "Host of live sources that users may have opened, a name or an address; repeatable (default: all, but with "
           "accounts not this machine and link-local addresses)")
      .TypeName("HOST")
      .OneValueEach();
  parser
      .Add("--max-copies", arguments->max_copies_gb,
           "What the copies of videos and the clips may take on the disk, in GB; those not used for the longest "
           "time are removed")
      .ShowDefault()
      .Range(0.001, 100'000.0)
      .TypeName("GB");
  Argument tiles = parser
                       .Add("--tiles", arguments->tiles,
                            "Base map: a PMTiles file, or the address of a tile server with {z}, {x} and {y}, which "
                            "learns what is looked at (default: coasts, borders and a grid, without the internet)")
                       .TypeName("FILE|URL");
  parser
      .Add("--tiles-attribution", arguments->tiles_attribution,
           "Whose map it is, shown on it (default: as the file says; of a server its host)")
      .Needs(tiles)
      .TypeName("TEXT");
  parser
      .Add("--access-log", arguments->access_log,
           "File to which each read of objects, videos, frames and other results is added before it is answered, with "
           "account, address and time; `doctor --check` verifies it (default: none)")
      .TypeName("FILE");
  parser.Add("--web", arguments->web, "The built page (default: as built or installed)").TypeName("DIR");
  return [=] { return Run(*arguments); };
}

}  // namespace victorious::cli
