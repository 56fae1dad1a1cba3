#include "victorious/store/postgres/connection.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <libpq-fe.h>
#include <poll.h>

#include "victorious/base/check.h"
#include "victorious/store/postgres/connection_error.h"
#include "victorious/store/sql/row.h"

namespace victorious::postgres {
namespace {

constexpr int kOldestServer = 150000;

// Of the advisory locks of Exclusion: "VICT" and "SERV" in ASCII.
constexpr std::int64_t kLockKey = 0x56494354;
constexpr std::int64_t kServerLockKey = 0x53455256;

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { PQconninfoFree(options); }
};
using OptionsPtr = std::unique_ptr<PQconninfoOption, FreeOptions>;

std::string OptionValue(const PQconninfoOption* options, std::string_view keyword) {
  for (const PQconninfoOption* option = options; option->keyword != nullptr; ++option) {
    if (option->keyword == keyword && option->val != nullptr) return option->val;
  }
  return {};
}

// "?" becomes "$1", "$2", …, except in quotes.
std::string NumberParameters(std::string_view sql) {
  std::string numbered;
  int parameter = 0;
  bool is_quoted = false;
  for (const char c : sql) {
    if (c == '\'') is_quoted = !is_quoted;
    if (c == '?' && !is_quoted) {
      numbered += fmt::format("${}", ++parameter);
    } else {
      numbered += c;
    }
  }
  return numbered;
}

// Parameters as libpq takes them; refers to those given.
struct ParameterArrays {
  explicit ParameterArrays(const BoundValues& parameters) {
    for (const BoundValues::Value& value : parameters.values()) {
      types.push_back(value.type);
      values.push_back(value.bytes ? value.bytes->data() : nullptr);
      lengths.push_back(value.bytes ? static_cast<int>(value.bytes->size()) : 0);
      formats.push_back(1);
    }
  }

  [[nodiscard]] int count() const { return static_cast<int>(values.size()); }

  std::vector<Oid> types;
  std::vector<const char*> values;
  std::vector<int> lengths;
  std::vector<int> formats;
};

// Whether a server answers at an address.
PGPing Ping(const std::string& url) {
  const std::array<const char*, 3> keywords = {"dbname", "connect_timeout", nullptr};
  const std::array<const char*, 3> values = {url.c_str(), "10", nullptr};
  return PQpingParams(keywords.data(), values.data(), 1);
}

// Where the password of a URL stands as its writer means it: after the first ":" of the authority, up to the last "@".
// Empty if there is none.
std::string_view PasswordIn(std::string_view url) {
  const std::size_t scheme = url.find("://");
  if (scheme == std::string_view::npos) return {};
  const std::size_t begin = scheme + 3;
  const std::size_t at = url.substr(0, url.find('?', begin)).rfind('@');
  const std::size_t colon = url.find(':', begin);
  if (at == std::string_view::npos || colon == std::string_view::npos || colon > at || at < begin) return {};
  return url.substr(colon + 1, at - colon - 1);
}

// True if libpq would end it elsewhere (RFC 3986, 3.2.1), and so take a part of it for the host, which errors name.
bool IsMisread(std::string_view password) {
  if (password.find_first_of("/@") != std::string_view::npos) return true;
  const auto is_digit = [&](std::size_t i) {
    return i < password.size() && std::isxdigit(static_cast<unsigned char>(password[i])) != 0;
  };
  for (std::size_t i = password.find('%'); i != std::string_view::npos; i = password.find('%', i + 1)) {
    if (!is_digit(i + 1) || !is_digit(i + 2)) return true;
  }
  return false;
}

}  // namespace

// As libpq reads a URL: the first "@" before the first "/" ends user and password, "?" begins the parameters.
StoreAddress TakePassword(const std::string& url) {
  const OptionsPtr options(PQconninfoParse(url.c_str(), nullptr));
  const std::string_view written = PasswordIn(url);
  if (IsMisread(written)) {
    std::string name = url;
    name.erase(static_cast<std::size_t>(written.data() - url.data()) - 1, written.size() + 1);
    return {.name = std::move(name), .password = std::string(written)};
  }
  if (!options) return {.name = url, .password = {}};
  const std::size_t begin = url.find("://") + 3;
  const std::size_t at = url.find_first_of("@/", begin);
  std::string name = url;
  if (at != std::string::npos && url[at] == '@') {
    const std::size_t colon = url.find(':', begin);
    if (colon < at) name.erase(colon, at - colon);
  }
  const std::size_t question = name.find('?');
  if (question != std::string::npos) {
    std::string kept;
    std::string_view rest = std::string_view(name).substr(question + 1);
    while (!rest.empty()) {
      const std::string_view part = rest.substr(0, rest.find('&'));
      rest.remove_prefix(std::min(part.size() + 1, rest.size()));
      if (part.starts_with("password=")) continue;
      kept += kept.empty() ? '?' : '&';
      kept += part;
    }
    name.replace(question, std::string::npos, kept);
  }
  return {.name = std::move(name), .password = OptionValue(options.get(), "password")};
}

std::string DatabaseName(const std::string& url) {
  const OptionsPtr options(PQconninfoParse(url.c_str(), nullptr));
  if (!options) return url;
  const std::string user = OptionValue(options.get(), "user");
  const std::string port = OptionValue(options.get(), "port");
  const std::string host = OptionValue(options.get(), "host");
  const bool is_socket = host.starts_with('/');
  return fmt::format("postgresql://{}{}{}{}/{}{}", user.empty() ? "" : user + "@", is_socket ? "" : host,
                     port.empty() ? "" : ":", port, OptionValue(options.get(), "dbname"),
                     is_socket ? "?host=" + host : "");
}

Expected<std::unique_ptr<Connection>> Connection::Open(const std::string& url, bool is_read_only,
                                                       std::string_view settings, std::optional<TaskAttempt> task) {
  if (IsMisread(PasswordIn(url))) {
    return Fail(
        ErrorCode::kInvalidArgument,
        "the password in the URL of the database has a / @ or % as it is: write %2F, %40 or %25 in its place, or "
        "give it by the variable PGPASSWORD");
  }
  char* fault = nullptr;
  const OptionsPtr options(PQconninfoParse(url.c_str(), &fault));
  if (!options) {
    const std::string reason = fault == nullptr ? "out of memory" : CollapseBlanks(fault);
    PQfreemem(fault);
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("not the URL of a database ({}): postgresql://user@host:port/database is", reason));
  }
  // What precedes dbname is a default, what follows it overrides the URL. A server that is gone is noticed in a minute.
  const std::string session =
      fmt::format("-c jit=off -c lock_timeout=60s {} {} {}", is_read_only ? "-c default_transaction_read_only=on" : "",
                  settings, OptionValue(options.get(), "options"));
  const std::array<std::pair<const char*, const char*>, 8> parameters = {{{"connect_timeout", "10"},
                                                                          {"application_name", "victorious"},
                                                                          {"tcp_user_timeout", "60000"},
                                                                          {"keepalives_idle", "30"},
                                                                          {"dbname", url.c_str()},
                                                                          {"client_encoding", "UTF8"},
                                                                          {"options", session.c_str()},
                                                                          {nullptr, nullptr}}};
  std::array<const char*, parameters.size()> keywords{};
  std::array<const char*, parameters.size()> values{};
  for (std::size_t i = 0; i < parameters.size(); ++i) std::tie(keywords[i], values[i]) = parameters[i];
  std::unique_ptr<Connection> connection(
      new Connection(DatabaseName(url), PQconnectdbParams(keywords.data(), values.data(), 1), task));
  if (connection->IsLost()) VICTORIOUS_RETURN_IF_ERROR(connection->ConnectAgain(url));
  VICTORIOUS_RETURN_IF_ERROR(connection->CheckServer());
  VICTORIOUS_RETURN_IF_ERROR(connection->PrepareSession());
  return connection;
}

Connection::~Connection() { PQfinish(handle_); }

// The first attempt gives no code: how much an error says can only be set of a connection that there is.
Status Connection::ConnectAgain(const std::string& url) {
  const std::string text = FirstLine(PQerrorMessage(handle_));
  const PGPing ping = Ping(url);
  if (ping == PQPING_NO_RESPONSE) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: {}: start the server, or correct its host and port", name_, text));
  }
  if (ping == PQPING_REJECT) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: {}: the server is starting or stopping: try again", name_, text));
  }
  PQsetErrorVerbosity(handle_, PQERRORS_VERBOSE);
  PQreset(handle_);
  PQsetErrorVerbosity(handle_, PQERRORS_DEFAULT);
  if (!IsLost()) return {};
  return std::unexpected(ErrorFromFailure(name_, ParseConnectionFailure(PQerrorMessage(handle_))));
}

Status Connection::CheckServer() const {
  if (PQserverVersion(handle_) < kOldestServer) {
    return Fail(ErrorCode::kUnsupported, fmt::format("{}: PostgreSQL {}: version 15 or later is needed", name_,
                                                     PQparameterStatus(handle_, "server_version")));
  }
  const std::string encoding = PQparameterStatus(handle_, "server_encoding");
  if (encoding != "UTF8") {
    return Fail(ErrorCode::kUnsupported,
                fmt::format("{}: the database has the encoding {}: create it with UTF8 (createdb -E UTF8 -T template0)",
                            name_, encoding));
  }
  return {};
}

// PostGIS may live in a schema of its own.
Status Connection::PrepareSession() {
  PQsetNoticeProcessor(handle_, [](void*, const char*) {}, nullptr);
  const std::string sql = fmt::format(
      "SELECT set_config('search_path', concat_ws(', ', '{}', coalesce((SELECT quote_ident(n.nspname) FROM "
      "pg_extension "
      "e JOIN pg_namespace n ON n.oid = e.extnamespace WHERE e.extname = 'postgis'), 'public')), false)",
      kSchemaName);
  const bool is_sent = PQsendQuery(handle_, sql.c_str()) == 1;
  const Expected<Result> set = is_sent ? Finish() : std::unexpected(ErrorFromResult(nullptr));
  if (!set) return std::unexpected(set.error());
  return {};
}

bool Connection::IsLost() const { return is_silent_ || PQstatus(handle_) != CONNECTION_OK; }

void Connection::ReadNotices() {
  pollfd socket = {.fd = PQsocket(handle_), .events = POLLIN, .revents = 0};
  // The end of a connection can be read, too.
  while (socket.fd >= 0 && ::poll(&socket, 1, 0) > 0 && PQconsumeInput(handle_) == 1 && !IsLost()) {
  }
}

Status Connection::Reconnect() {
  prepared_.clear();
  PQreset(handle_);
  is_silent_ = false;
  if (IsLost()) {
    return Fail(ErrorCode::kUnavailable, fmt::format("{}: the connection was lost: {}: start the server again", name_,
                                                     FirstLine(PQerrorMessage(handle_))));
  }
  return PrepareSession();
}

bool Connection::AwaitReply() {
  if (!reply_timeout_) return true;
  const auto end = std::chrono::steady_clock::now() + *reply_timeout_;
  while (PQisBusy(handle_) == 1) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
    pollfd socket = {.fd = PQsocket(handle_), .events = POLLIN, .revents = 0};
    if (socket.fd < 0) return true;  // closed: libpq says so
    // Once more also when the time is over: this process may have stood still.
    if (::poll(&socket, 1, static_cast<int>(std::max<decltype(left)>(left, 0))) > 0) {
      if (PQconsumeInput(handle_) != 1) return true;
    } else if (left <= 0) {
      is_silent_ = true;
      return false;
    }
  }
  return true;
}

Expected<Result> Connection::Finish() {
  std::optional<Result> last;
  std::optional<Error> error;
  while (true) {
    if (!AwaitReply()) {
      return Fail(ErrorCode::kUnavailable, fmt::format("{}: the server has not answered for {} s: run it again", name_,
                                                       std::chrono::duration<double>(*reply_timeout_).count()));
    }
    PGresult* const result = PQgetResult(handle_);
    if (result == nullptr) break;
    const ExecStatusType status = PQresultStatus(result);
    if (status == PGRES_FATAL_ERROR || status == PGRES_BAD_RESPONSE) {
      // An error of sending, not of the server: libpq may not have read yet that the connection has ended.
      if (PQresultErrorField(result, PG_DIAG_SQLSTATE) == nullptr) ReadNotices();
      if (!error) error = ErrorFromResult(result);
    }
    last.emplace(result);
    if (status == PGRES_COPY_IN) break;  // the rows come next
  }
  if (error) return std::unexpected(*std::move(error));
  if (!last) return std::unexpected(ErrorFromResult(nullptr));
  return *std::move(last);
}

Expected<Result> Connection::Run(const std::function<bool()>& send) {
  const bool may_reconnect = !is_in_transaction_ && cursors_ == 0;
  if (IsLost() && may_reconnect) VICTORIOUS_RETURN_IF_ERROR(Reconnect());
  Expected<Result> result = send() ? Finish() : std::unexpected(ErrorFromResult(nullptr));
  if (!result && IsLost() && may_reconnect) {
    VICTORIOUS_RETURN_IF_ERROR(Reconnect());
    result = send() ? Finish() : std::unexpected(ErrorFromResult(nullptr));
  }
  return result;
}

Expected<Result> Connection::Query(std::string_view sql, const BoundValues& parameters) {
  const std::string numbered = NumberParameters(sql);
  const ParameterArrays arrays(parameters);
  return Run([&] {
    return PQsendQueryParams(handle_, numbered.c_str(), arrays.count(), arrays.types.data(), arrays.values.data(),
                             arrays.lengths.data(), arrays.formats.data(), 1) == 1;
  });
}

Expected<std::string> Connection::Prepare(std::string_view sql, const BoundValues& parameters) {
  if (const auto known = prepared_.find(sql); known != prepared_.end()) return known->second;
  const std::string name = fmt::format("write_{}", prepared_.size());
  const ParameterArrays arrays(parameters);
  const bool is_sent =
      PQsendPrepare(handle_, name.c_str(), NumberParameters(sql).c_str(), arrays.count(), arrays.types.data()) == 1;
  const Expected<Result> result = is_sent ? Finish() : std::unexpected(ErrorFromResult(nullptr));
  if (!result) return std::unexpected(result.error());
  prepared_.emplace(sql, name);
  return name;
}

Expected<Result> Connection::Write(std::string_view sql, const BoundValues& parameters) {
  VICTORIOUS_CHECK(!is_in_transaction_ && cursors_ == 0);
  ReadNotices();
  if (IsLost()) VICTORIOUS_RETURN_IF_ERROR(Reconnect());
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string name, Prepare(sql, parameters));
  const ParameterArrays arrays(parameters);
  const bool is_sent = PQsendQueryPrepared(handle_, name.c_str(), arrays.count(), arrays.values.data(),
                                           arrays.lengths.data(), arrays.formats.data(), 1) == 1;
  return is_sent ? Finish() : std::unexpected(ErrorFromResult(nullptr));
}

Status Connection::Execute(const std::string& sql) {
  const Expected<Result> result = Run([&] { return PQsendQuery(handle_, sql.c_str()) == 1; });
  if (!result) return std::unexpected(result.error());
  return {};
}

Status Connection::Copy(std::string_view target, const CopyRows& rows) {
  VICTORIOUS_CHECK(is_in_transaction_);
  VICTORIOUS_RETURN_IF_ERROR(Execute(fmt::format("COPY {} FROM STDIN (FORMAT binary)", target)));
  constexpr std::size_t kPieceBytes = std::size_t{1} << 20;
  bool is_sent = true;
  const std::string_view bytes = rows.bytes();
  for (std::size_t at = 0; is_sent && at < bytes.size(); at += kPieceBytes) {
    const std::string_view piece = bytes.substr(at, kPieceBytes);
    is_sent = PQputCopyData(handle_, piece.data(), static_cast<int>(piece.size())) == 1;
  }
  // The end of the rows: a count of columns of -1.
  is_sent = is_sent && PQputCopyData(handle_, "\xFF\xFF", 2) == 1 && PQputCopyEnd(handle_, nullptr) == 1;
  const Expected<Result> result = is_sent ? Finish() : std::unexpected(ErrorFromResult(nullptr));
  if (!result) return std::unexpected(result.error());
  return {};
}

Status Connection::VisitCursor(const std::string& cursor, int rows_at_once,
                               const std::function<Expected<bool>(const Result&)>& visit) {
  const std::string fetch = fmt::format("FETCH FORWARD {} FROM {}", rows_at_once, cursor);
  while (true) {
    VICTORIOUS_ASSIGN_OR_RETURN(Result rows, Query(fetch));
    while (rows.Next()) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool goes_on, visit(rows));
      if (!goes_on) return {};
    }
    if (rows.RowCount() < rows_at_once) return {};
  }
}

Status Connection::Visit(std::string_view sql, const BoundValues& parameters, int rows_at_once,
                         const std::function<Expected<bool>(const Result&)>& visit) {
  const bool is_outermost = cursors_ == 0 && !is_in_transaction_;
  if (is_outermost) VICTORIOUS_RETURN_IF_ERROR(Execute("BEGIN READ ONLY"));
  const std::string cursor = fmt::format("visit_{}", ++cursors_);
  Expected<Result> declared = Query(fmt::format("DECLARE {} NO SCROLL CURSOR FOR {}", cursor, sql), parameters);
  Status status;
  if (declared) {
    status = VisitCursor(cursor, rows_at_once, visit);
  } else {
    status = std::unexpected(std::move(declared).error());
  }
  if (is_outermost) {
    const Status ended = IsLost() ? Status() : Execute("ROLLBACK");
    if (status) status = ended;
  } else if (status) {
    status = Execute("CLOSE " + cursor);
  }
  --cursors_;
  return status;
}

Error Connection::ErrorFromResult(const pg_result* result) const {
  const char* const text = result == nullptr ? PQerrorMessage(handle_) : PQresultErrorMessage(result);
  const char* const primary = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
  const std::string reason = primary == nullptr ? FirstLine(text) : CollapseBlanks(primary);
  const char* const field = result == nullptr ? nullptr : PQresultErrorField(result, PG_DIAG_SQLSTATE);
  const std::string state = field == nullptr ? "" : field;
  // PostgreSQL's manual, appendix A. The first two characters are the class.
  if (IsLost() || state.starts_with("08") || state.starts_with("57P")) {
    return {ErrorCode::kUnavailable,
            fmt::format("{}: the connection was lost ({}): nothing of this transaction is written, "
                        "unless it was lost at its end: run it again",
                        name_, reason)};
  }
  if (state == "23503") {
    return {ErrorCode::kNotFound,
            fmt::format("{}: refers to a video or model that is not in the index (another process "
                        "may have replaced it): run it again",
                        name_)};
  }
  if (state.starts_with("23")) {
    return {ErrorCode::kInvalidArgument, fmt::format("{}: violates a constraint of the index: {}", name_, reason)};
  }
  if (state == "42501") {
    return {ErrorCode::kPermissionDenied, fmt::format("{}: {}: grant it to the role", name_, reason)};
  }
  if (state == "25006") {
    return {ErrorCode::kPermissionDenied, fmt::format("{}: open for reading only: {}", name_, reason)};
  }
  if (state == "53100") {
    return {ErrorCode::kNoSpace,
            fmt::format("{}: no space left on the server's disk: free some, then run it again", name_)};
  }
  if (state == "55P03" || state.starts_with("40")) {
    // Not kConflict, which says that another process does the same work.
    return {
        ErrorCode::kUnavailable,
        fmt::format("{}: the database is busy, other processes hold its locks ({}): run this again", name_, reason)};
  }
  if (state == "42P01" || state == "42703" || state == "3F000") {
    return {ErrorCode::kDataLoss, fmt::format("{}: the schema does not match the version ({}): restore it from a copy, "
                                              "or index again",
                                              name_, reason)};
  }
  if (state.starts_with("XX")) return sql::DamagedIndex(name_, reason);
  return {ErrorCode::kInternal, fmt::format("{}: PostgreSQL: {} (SQLSTATE {})", name_, reason, state)};
}

Expected<Transaction> Transaction::Begin(Connection& connection, Exclusion exclusion) {
  VICTORIOUS_CHECK(!connection.is_in_transaction_ && connection.cursors_ == 0);
  VICTORIOUS_RETURN_IF_ERROR(connection.Execute("BEGIN; SET LOCAL idle_in_transaction_session_timeout = '60s'"));
  connection.is_in_transaction_ = true;
  Transaction transaction(connection);
  if (exclusion == Exclusion::kNothing) return transaction;
  const std::string_view share = exclusion == Exclusion::kShared ? "_shared" : "";
  const std::int64_t key = exclusion == Exclusion::kServer ? kServerLockKey : kLockKey;
  VICTORIOUS_RETURN_IF_ERROR(connection.Execute(fmt::format("SELECT pg_advisory_xact_lock{}({})", share, key)));
  if (connection.task_ && exclusion != Exclusion::kServer) VICTORIOUS_RETURN_IF_ERROR(connection.CheckTask());
  return transaction;
}

Expected<Transaction> Transaction::BeginReading(Connection& connection) {
  VICTORIOUS_CHECK(!connection.is_in_transaction_ && connection.cursors_ == 0);
  VICTORIOUS_RETURN_IF_ERROR(connection.Execute(
      "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY; SET LOCAL idle_in_transaction_session_timeout = '60s'"));
  connection.is_in_transaction_ = true;
  return Transaction(connection);
}

// The lock does not hinder the worker, which renews its lease by changing the row (FOR NO KEY UPDATE), but those who
// end a lost lease or claim the task (FOR UPDATE).
Status Connection::CheckTask() {
  VICTORIOUS_ASSIGN_OR_RETURN(
      Result running, Query("SELECT 1 FROM tasks WHERE id = ? AND attempt = ? AND state = 'running' FOR KEY SHARE",
                            task_->task, task_->attempt));
  if (running.Next()) return {};
  return Fail(ErrorCode::kConflict,
              fmt::format("{}: attempt {} of task {} does not run any more: its lease was lost, and another worker may "
                          "do it; nothing of this transaction is written",
                          name_, task_->attempt, task_->task));
}

Transaction::~Transaction() {
  if (connection_ == nullptr) return;
  // If the connection is lost, the server rolls back.
  if (!connection_->IsLost()) [[maybe_unused]]
    const Status status = connection_->Execute("ROLLBACK");
  connection_->is_in_transaction_ = false;
}

Status Transaction::Commit() {
  VICTORIOUS_RETURN_IF_ERROR(connection_->Execute("COMMIT"));
  std::exchange(connection_, nullptr)->is_in_transaction_ = false;
  return {};
}

}  // namespace victorious::postgres
