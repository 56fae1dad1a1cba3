#include "victorious/apps/serve/access_control.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "victorious/apps/serve/api_response.h"
#include "victorious/apps/serve/secret.h"
#include "victorious/base/json.h"
#include "victorious/base/utc.h"
#include "victorious/base/without_folders.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

constexpr std::size_t kSecretLength = 43;
constexpr int kMaxLogIns = 4;
constexpr std::string_view kBearer = "Bearer ";

HttpResponse Unauthenticated(std::string_view message) {
  HttpResponse response = ErrorResponse(401, "unauthenticated", message);
  response.headers.emplace_back("WWW-Authenticate", "Bearer");
  return response;
}

HttpResponse TooManyLogIns(std::int64_t wait_s) {
  HttpResponse response = ErrorResponse(429, "too_many_requests",
                                        fmt::format("too many log-ins have failed: try again in {} seconds", wait_s));
  response.headers.emplace_back("Retry-After", std::to_string(wait_s));
  return response;
}

HttpResponse SessionResponse(const std::optional<Account>& account, bool has_accounts) {
  Json json = {{"has_accounts", has_accounts}, {"account", nullptr}};
  if (account) json["account"] = {{"name", account->name}, {"role", ToText(account->role)}};
  return JsonResponse(json);
}

bool IsSecret(std::string_view text) {
  return text.size() == kSecretLength && std::ranges::all_of(text, [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
         });
}

AuditRecord MakeRecord(std::string actor, std::string_view action, std::string subject, std::string detail) {
  return {.id = 0,
          .time_utc_us = NowUtcMicroseconds(),
          .actor = std::move(actor),
          .action = std::string(action),
          .subject = std::move(subject),
          .detail = std::move(detail)};
}

// Counts itself among those that run.
class Running {
 public:
  explicit Running(std::atomic<int>& count) : count_(count), number_(++count) {}
  ~Running() { --count_; }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  std::atomic<int>& count_;
  int number_;
};

}  // namespace

std::int64_t SteadyMicroseconds() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::string FindCookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    std::string_view part = header.substr(0, header.find(';'));
    header.remove_prefix(std::min(part.size() + 1, header.size()));
    while (part.starts_with(' ') || part.starts_with('\t')) part.remove_prefix(1);
    while (part.ends_with(' ') || part.ends_with('\t')) part.remove_suffix(1);
    if (part.size() > name.size() && part.starts_with(name) && part[name.size()] == '=') {
      return std::string(part.substr(name.size() + 1));
    }
  }
  return {};
}

Expected<std::unique_ptr<AccessControl>> AccessControl::Open(const std::string& index, bool can_write,
                                                             const ServerIdentity& server, Clock clock) {
  std::unique_ptr<AccountStore> writer;
  if (can_write) {
    VICTORIOUS_ASSIGN_OR_RETURN(writer, OpenAccountStore(index, StoreMode::kCreate));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(auto reader, OpenAccountStore(index, StoreMode::kRead));
  std::unique_ptr<AccessControl> control(
      new AccessControl(std::move(reader), std::move(writer), server, std::move(clock)));
  VICTORIOUS_ASSIGN_OR_RETURN(const bool needs_account, control->NeedsAccount());
  if (!needs_account && !server.is_loopback) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("--listen: {} has no accounts, so only a loopback address (127.0.0.1, [::1]) is served: add "
                    "one by `victorious user add NAME --role admin --db {}`, or use an SSH tunnel",
                    StoreName(index), StoreName(index)));
  }
  if (needs_account && !can_write) {
    return Fail(ErrorCode::kPermissionDenied,
                fmt::format("{}: has accounts, but cannot be written, so nobody can log "
                            "in: allow writing to {}",
                            StoreName(index), IsDatabaseUrl(index) ? "the role" : "the file and its folder"));
  }
  if (!server.is_loopback) control->needs_account_ = true;
  if (control->writer_) VICTORIOUS_RETURN_IF_ERROR(control->writer_->RemoveExpired(NowUtcMicroseconds()));
  return control;
}

Expected<bool> AccessControl::NeedsAccount() {
  if (needs_account_) return true;
  const std::scoped_lock lock(reader_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(const bool has_accounts, reader_->HasAccounts());
  if (has_accounts) needs_account_ = true;
  return has_accounts;
}

// Cookies belong to a host, not to a port: the port keeps two servers of one machine apart.
std::string AccessControl::CookieName(int port) const {
  return fmt::format("{}victorious_{}", server_.has_tls ? "__Host-" : "", port);
}

std::string AccessControl::Cookie(int port, std::string_view value, std::int64_t max_age_s) const {
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict; Max-Age={}{}", CookieName(port), value, max_age_s,
                     server_.has_tls ? "; Secure" : "");
}

Expected<Caller> AccessControl::Identify(const HttpRequest& request, int port) {
  VICTORIOUS_ASSIGN_OR_RETURN(const bool needs_account, NeedsAccount());
  if (!needs_account) return Caller{.proved = {}, .is_open = true};
  const bool is_token = !request.authorization.empty();
  const std::string secret = is_token
                                 ? request.authorization.substr(std::min(kBearer.size(), request.authorization.size()))
                                 : FindCookie(request.cookie, CookieName(port));
  if (!IsSecret(secret) || (is_token && !request.authorization.starts_with(kBearer))) return Caller{};
  const std::scoped_lock lock(reader_mutex_);
  VICTORIOUS_ASSIGN_OR_RETURN(auto proved, reader_->Prove(DigestSecret(secret), UtcMicroseconds()));
  const CredentialKind kind = is_token ? CredentialKind::kToken : CredentialKind::kSession;
  if (!proved || proved->credential.kind != kind) return Caller{};
  return Caller{.proved = std::move(proved), .is_open = false};
}

std::expected<Caller, HttpResponse> AccessControl::Admit(const HttpRequest& request, std::optional<Role> least,
                                                         int port) {
  auto caller = Identify(request, port);
  if (!caller) {  // it is not known who asks
    caller.error().message = WithoutFolders(caller.error().message);
    return std::unexpected(ErrorResponse(ApiError(caller.error())));
  }
  if (caller->May(least)) return *std::move(caller);
  if (!caller->proved) {
    return std::unexpected(Unauthenticated(request.authorization.empty()
                                               ? "log in first: there is no session, or it has ended"
                                               : "the token is not valid, or has ended"));
  }
  return std::unexpected(
      ErrorResponse(403, "forbidden",
                    fmt::format("the account {} has the role {}: this needs the role {}", caller->name(),
                                ToText(caller->proved->account.role), ToText(*least))));
}

Status AccessControl::CheckStore() {
  const std::scoped_lock lock(reader_mutex_);
  const auto asked = reader_->HasAccounts();
  if (!asked) return std::unexpected(asked.error());
  return {};
}

Expected<std::int64_t> AccessControl::CountSessions() {
  const std::scoped_lock lock(reader_mutex_);
  return reader_->CountSessions(UtcMicroseconds());
}

ApiExpected<HttpResponse> AccessControl::Session(const Caller& caller) {
  return SessionResponse(caller.proved ? std::optional(caller.proved->account) : std::nullopt, !caller.is_open);
}

Expected<std::optional<AccessControl::CheckedAccount>> AccessControl::CheckPasswordOf(const std::string& name,
                                                                                      const std::string& password) {
  std::optional<Account> account;
  std::string hash;
  {
    const std::scoped_lock lock(reader_mutex_);
    VICTORIOUS_ASSIGN_OR_RETURN(account, reader_->Find(name));
    if (account) {
      VICTORIOUS_ASSIGN_OR_RETURN(hash, reader_->PasswordHash(account->id));
    }
  }
  const std::scoped_lock lock(hash_mutex_);
  if (!account) {
    SpendPasswordTime(password);
    return std::nullopt;
  }
  if (!IsPassword(password, hash)) return std::nullopt;
  return CheckedAccount{.account = *std::move(account), .hash = std::move(hash)};
}

ApiExpected<HttpResponse> AccessControl::RefuseLogIn(const HttpRequest& request, const std::string& name) {
  // The name is not in the log unless it is an account's: people type a password into the wrong field.
  std::optional<Account> known;
  {
    const std::scoped_lock lock(reader_mutex_);
    VICTORIOUS_ASSIGN_OR_RETURN(known, reader_->Find(name));
  }
  VICTORIOUS_RETURN_IF_ERROR(Log({}, "log_in_refused", known ? "account " + known->name : "an unknown account",
                                 DumpJson(Json({{"client", request.client}}))));
  return Unauthenticated("Name or password is wrong");
}

ApiExpected<HttpResponse> AccessControl::LogIn(const HttpRequest& request, int port) {
  const auto body = ParseJson(request.body);
  if (!body) return std::unexpected(ApiError(body.error()));
  // Another process may add accounts to an index that this one cannot write.
  if (!writer_) {
    return std::unexpected(ApiError(Error{ErrorCode::kPermissionDenied,
                                          "the index cannot be written, so nobody can log in: allow writing to it, "
                                          "then start again"}));
  }
  for (const char* member : {"name", "password"}) {
    if (!body->is_object() || !body->contains(member) || !(*body)[member].is_string()) {
      return FailField(member, fmt::format("The {} must be a text", member));
    }
  }
  const auto name = (*body)["name"].get<std::string>();
  const auto password = (*body)["password"].get<std::string>();
  if (!CheckAccountName(name)) return Unauthenticated("Name or password is wrong");
  const Running running(log_ins_);
  if (running.number() > kMaxLogIns) return TooManyLogIns(1);
  if (const auto wait_s = limiter_.Take(request.client, name, clock_())) {
    return TooManyLogIns(*wait_s);
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const auto checked, CheckPasswordOf(name, password));
  if (!checked) return RefuseLogIn(request, name);
  const Account& account = checked->account;
  VICTORIOUS_ASSIGN_OR_RETURN(const std::string secret, MakeSecret());
  constexpr std::int64_t kLifetimeS = std::int64_t{kSessionHours} * 3600;
  const auto session = [&] {
    const std::scoped_lock lock(writer_mutex_);
    return writer_->ChangeAndLog([&]() -> Expected<AuditRecord> {
      VICTORIOUS_RETURN_IF_ERROR(writer_->AddCredential({.account = account.id,
                                                         .kind = CredentialKind::kSession,
                                                         .digest = DigestSecret(secret),
                                                         .now_us = UtcMicroseconds(),
                                                         .lifetime_us = kLifetimeS * 1'000'000,
                                                         .proved_hash = checked->hash}));
      return MakeRecord(account.name, "log_in", "account " + account.name,
                        DumpJson(Json({{"client", request.client}})));
    });
  }();
  if (!session) {
    // The password was changed, or the account removed, while the password was compared.
    const ErrorCode code = session.error().code;
    if (code == ErrorCode::kConflict || code == ErrorCode::kNotFound) return RefuseLogIn(request, name);
    return std::unexpected(ApiError(session.error()));
  }
  limiter_.PutBack(request.client, name);
  HttpResponse response = SessionResponse(account, /*has_accounts=*/true);
  response.headers.emplace_back("Set-Cookie", Cookie(port, secret, kLifetimeS));
  return response;
}

ApiExpected<HttpResponse> AccessControl::LogOut(const Caller& caller, int port) {
  if (writer_ && caller.proved && caller.proved->credential.kind == CredentialKind::kSession) {
    const std::scoped_lock lock(writer_mutex_);
    const Status removed = writer_->ChangeAndLog([&]() -> Expected<AuditRecord> {
      VICTORIOUS_RETURN_IF_ERROR(writer_->RemoveCredential(caller.proved->account.id, caller.proved->credential.id));
      return MakeRecord(caller.name(), "log_out", "account " + caller.name(), "");
    });
    // Ended meanwhile, by another request.
    if (!removed && removed.error().code != ErrorCode::kNotFound) return std::unexpected(ApiError(removed.error()));
  }
  HttpResponse response = SessionResponse(std::nullopt, !caller.is_open);
  response.headers.emplace_back("Set-Cookie", Cookie(port, "", 0));
  return response;
}

Status AccessControl::Log(const Caller& caller, std::string_view action, std::string subject, std::string detail) {
  if (!writer_) return {};
  const std::scoped_lock lock(writer_mutex_);
  return writer_->Log(MakeRecord(caller.name(), action, std::move(subject), std::move(detail)));
}

Expected<std::vector<AuditRecord>> AccessControl::Audit(std::int64_t limit, std::optional<std::int64_t> before) {
  const std::scoped_lock lock(reader_mutex_);
  return reader_->Audit(limit, before);
}

}  // namespace victorious
