// Who may use the server of an index, and who did what there. Input: accounts with hashed passwords, digests of
// sessions and tokens, entries of the log (from serve/). Output: the same. No secret is stored in clear, and none is
// computed here: apps/serve/secret.h does that.
//
// Accounts belong to the index that `victorious serve` shows. They are not the roles of a PostgreSQL server, which say
// what programs may do to the database.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "victorious/base/enum_text.h"
#include "victorious/base/error.h"
#include "victorious/store/audit_record.h"
#include "victorious/store/index_store.h"

namespace victorious {

/// What an account may do. Each role may do what the former ones may.
enum class Role {
  kViewer,   ///< look
  kAnalyst,  ///< review, add videos and models
  kAdmin,    ///< read the log of who did what
};

/// The texts in the index, in the API and on the command line.
inline constexpr auto kRoleTexts =
    std::to_array<EnumText<Role>>({{Role::kViewer, "viewer"}, {Role::kAnalyst, "analyst"}, {Role::kAdmin, "admin"}});

constexpr std::string_view ToText(Role role) { return ToText(kRoleTexts, role); }

struct Account {
  std::int64_t id = 0;
  std::string name;
  Role role = Role::kViewer;
  std::int64_t created_utc_us = 0;  ///< microseconds since 1970, as all times here
};

/// What proves an account beside its password.
enum class CredentialKind {
  kSession,  ///< of a browser, from log-in to log-out
  kToken,    ///< of a script
};

/// The texts in the index.
inline constexpr auto kCredentialKindTexts =
    std::to_array<EnumText<CredentialKind>>({{CredentialKind::kSession, "session"}, {CredentialKind::kToken, "token"}});

constexpr std::string_view ToText(CredentialKind kind) { return ToText(kCredentialKindTexts, kind); }

struct Credential {
  std::int64_t id = 0;
  std::int64_t account = 0;
  CredentialKind kind = CredentialKind::kSession;
  std::string label;  ///< what a token is for; of a session empty
  std::int64_t created_utc_us = 0;
  std::int64_t expires_utc_us = 0;
};

/// A credential to be stored under the digest of its secret.
struct NewCredential {
  std::int64_t account = 0;
  CredentialKind kind = CredentialKind::kSession;
  std::string digest;
  std::string label;
  std::int64_t now_us = 0;
  std::int64_t lifetime_us = 0;
  /// The hash that the account's password was compared with; std::nullopt: no password was asked for.
  std::optional<std::string> proved_hash;
};

/// Sessions of one account, at most: the next one ends the oldest.
inline constexpr std::int64_t kMaxSessions = 20;

/// An account that a credential has proved.
struct ProvedAccount {
  Account account;
  Credential credential;
};

/// Errors: kInvalidArgument unless it is 1 to 64 letters, digits and ". _ - @", and begins with a letter or digit.
[[nodiscard]] Status CheckAccountName(std::string_view name);

/// Not thread-safe: use from one thread at a time. Any number of processes may use the same accounts. Names are
/// compared without regard to the case of ASCII letters.
class AccountStore {
 public:
  virtual ~AccountStore() = default;

  /// From then on, only the user that has the file of the index may read it. Errors: those of CheckAccountName;
  /// kAlreadyExists.
  [[nodiscard]] virtual Expected<Account> Add(const std::string& name, Role role, const std::string& password_hash,
                                              std::int64_t now_us) = 0;
  /// Error: kNotFound.
  [[nodiscard]] virtual Status SetRole(const std::string& name, Role role) = 0;
  /// Also ends the account's sessions and tokens. Error: kNotFound.
  [[nodiscard]] virtual Status SetPassword(const std::string& name, const std::string& password_hash) = 0;
  /// Also ends the account's sessions and tokens; its reviews and entries of the log stay. Error: kNotFound.
  [[nodiscard]] virtual Status Remove(const std::string& name) = 0;

  [[nodiscard]] virtual Expected<std::vector<Account>> Accounts() = 0;  ///< by name
  [[nodiscard]] virtual Expected<bool> HasAccounts() = 0;
  [[nodiscard]] virtual Expected<std::optional<Account>> Find(const std::string& name) = 0;
  /// Returns the hash of an account's password. Error: kNotFound.
  [[nodiscard]] virtual Expected<std::string> PasswordHash(std::int64_t account) = 0;

  /// Stores a credential; drops those that have expired, and of sessions the oldest beyond kMaxSessions. Errors:
  /// kNotFound if the account is gone; kConflict if its password has changed since it was proved.
  [[nodiscard]] virtual Expected<Credential> AddCredential(const NewCredential& added) = 0;
  /// The account whose credential has this digest and has not expired; std::nullopt: there is none.
  [[nodiscard]] virtual Expected<std::optional<ProvedAccount>> Prove(const std::string& digest,
                                                                     std::int64_t now_us) = 0;
  /// Deletes the credentials that have expired.
  [[nodiscard]] virtual Status RemoveExpired(std::int64_t now_us) = 0;
  /// Sessions of all accounts that have not expired.
  [[nodiscard]] virtual Expected<std::int64_t> CountSessions(std::int64_t now_us) = 0;
  /// Ends a credential. Error: kNotFound.
  [[nodiscard]] virtual Status RemoveCredential(std::int64_t account, std::int64_t credential) = 0;
  /// The tokens of an account, oldest first.
  [[nodiscard]] virtual Expected<std::vector<Credential>> Tokens(std::int64_t account) = 0;

  /// Writes an entry to the log that goes with no change of the index.
  [[nodiscard]] virtual Status Log(const AuditRecord& record) = 0;
  /// Makes a change by the functions above, and writes the entry that it returns, in one transaction. Errors: those of
  /// `change`; then nothing is changed.
  [[nodiscard]] virtual Status ChangeAndLog(const std::function<Expected<AuditRecord>()>& change) = 0;
  /// The `limit` latest entries with an id below `before`, latest first.
  [[nodiscard]] virtual Expected<std::vector<AuditRecord>> Audit(std::int64_t limit,
                                                                 std::optional<std::int64_t> before) = 0;
};

/// Opens the accounts of an index, that OpenStore opens under this name. Errors: those of OpenStore.
[[nodiscard]] Expected<std::unique_ptr<AccountStore>> OpenAccountStore(const std::string& name, StoreMode mode);

}  // namespace victorious
