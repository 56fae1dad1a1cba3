// Who sends a request, and log-in and log-out. Thread-safe.
//
// An index without accounts, served on a loopback address, is open to everybody on this machine. As soon as it has an
// account, and on any other address, a request needs a session (a cookie) or a token (the header Authorization).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "victorious/apps/serve/api_error.h"
#include "victorious/apps/serve/http_message.h"
#include "victorious/apps/serve/log_in_limiter.h"
#include "victorious/apps/serve/request_guard.h"
#include "victorious/base/utc.h"
#include "victorious/store/account_store.h"

namespace victorious {

/// Who sends a request.
struct Caller {
  std::optional<ProvedAccount> proved;  ///< std::nullopt: nobody in particular
  bool is_open = false;                 ///< there are no accounts: everything is allowed

  [[nodiscard]] bool May(std::optional<Role> least) const {
    return is_open || !least || (proved && proved->account.role >= *least);
  }
  /// Empty: nobody in particular.
  [[nodiscard]] std::string name() const { return proved ? proved->account.name : ""; }
};

/// The value of a cookie in the header Cookie; empty: there is none. Accepts any bytes.
[[nodiscard]] std::string FindCookie(std::string_view header, std::string_view name);

/// Hours for which a log-in is valid.
inline constexpr int kSessionHours = 12;

/// Microseconds of a clock that nobody sets. Thread-safe.
[[nodiscard]] std::int64_t SteadyMicroseconds();

class AccessControl {
 public:
  using Clock = std::function<std::int64_t()>;

  /// @param index      by the name that OpenStore takes
  /// @param can_write  it can be written
  /// @param clock      by which failed log-ins are limited and credentials end; thread-safe
  /// Errors: kInvalidArgument for an address that is not a loopback address without accounts; kPermissionDenied for
  /// accounts in an index that cannot be written; those of OpenAccountStore.
  [[nodiscard]] static Expected<std::unique_ptr<AccessControl>> Open(const std::string& index, bool can_write,
                                                                     const ServerIdentity& server,
                                                                     Clock clock = SteadyMicroseconds);

  /// Who sends the request, or the response that refuses it: 401 without a valid credential where one is needed, 403 if
  /// the account's role is not enough.
  /// @param least  role that an account needs; std::nullopt: open to everybody
  [[nodiscard]] std::expected<Caller, HttpResponse> Admit(const HttpRequest& request, std::optional<Role> least,
                                                          int port);

  /// The routes of sessions. LogIn: kPermissionDenied if the index cannot be written.
  [[nodiscard]] ApiExpected<HttpResponse> Session(const Caller& caller);
  [[nodiscard]] ApiExpected<HttpResponse> LogIn(const HttpRequest& request, int port);
  [[nodiscard]] ApiExpected<HttpResponse> LogOut(const Caller& caller, int port);

  /// Asks the store something small. Errors: those of reading.
  [[nodiscard]] Status CheckStore();
  /// Sessions that have not ended.
  [[nodiscard]] Expected<std::int64_t> CountSessions();

  /// Writes to the log what changes nothing in the index, if that can be written.
  [[nodiscard]] Status Log(const Caller& caller, std::string_view action, std::string subject, std::string detail);
  [[nodiscard]] Expected<std::vector<AuditRecord>> Audit(std::int64_t limit, std::optional<std::int64_t> before);

 private:
  AccessControl(std::unique_ptr<AccountStore> reader, std::unique_ptr<AccountStore> writer,
                const ServerIdentity& server, Clock clock)
      : reader_(std::move(reader)),
        writer_(std::move(writer)),
        server_(server),
        clock_(std::move(clock)),
        started_us_(clock_()) {}

  /// An account, and the hash that its password was compared with.
  struct CheckedAccount {
    Account account;
    std::string hash;
  };

  /// True from the first account on: removing the last one opens nothing.
  [[nodiscard]] Expected<bool> NeedsAccount();
  /// UTC at the start, and what has passed since by the clock that nobody sets: a system clock that is set ahead ends
  /// no session, and one that is set back revives none.
  [[nodiscard]] std::int64_t UtcMicroseconds() const { return started_utc_us_ + clock_() - started_us_; }
  [[nodiscard]] Expected<Caller> Identify(const HttpRequest& request, int port);
  /// The account of a name and password; std::nullopt: wrong.
  [[nodiscard]] Expected<std::optional<CheckedAccount>> CheckPasswordOf(const std::string& name,
                                                                        const std::string& password);
  [[nodiscard]] ApiExpected<HttpResponse> RefuseLogIn(const HttpRequest& request, const std::string& name);
  [[nodiscard]] std::string CookieName(int port) const;
  [[nodiscard]] std::string Cookie(int port, std::string_view value, std::int64_t max_age_s) const;

  std::mutex reader_mutex_;
  std::unique_ptr<AccountStore> reader_;  ///< of its own: no request waits while another process writes
  std::mutex writer_mutex_;
  std::unique_ptr<AccountStore> writer_;  ///< null: the index cannot be written
  ServerIdentity server_;
  Clock clock_;
  std::int64_t started_us_;  ///< by the clock
  std::int64_t started_utc_us_ = NowUtcMicroseconds();
  std::atomic<bool> needs_account_ = false;
  LogInLimiter limiter_;
  std::atomic<int> log_ins_ = 0;  ///< that hash a password or wait to do so
  std::mutex hash_mutex_;         ///< one at a time: each takes 64 MiB
};

}  // namespace victorious
