// AccountStore in an index.
#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/store/account_store.h"
#include "victorious/store/sql/audit.h"
#include "victorious/store/sql/database.h"

namespace victorious::sql {
namespace {

constexpr std::string_view kSelectAccounts = "SELECT id, name, role, created_utc_us FROM accounts ";

Expected<Account> ReadAccount(const Row& row, std::string_view name) {
  const auto role = FromText(kRoleTexts, row.Text(2));
  if (!role) return std::unexpected(DamagedIndex(name, fmt::format("an account with the role \"{}\"", row.Text(2))));
  return Account{.id = row.Integer(0), .name = row.Text(1), .role = *role, .created_utc_us = row.Integer(3)};
}

// Columns id, account_id, kind, label, created_utc_us, expires_utc_us from `first` on.
Expected<Credential> ReadCredential(const Row& row, int first, std::string_view name) {
  const auto kind = FromText(kCredentialKindTexts, row.Text(first + 2));
  if (!kind) {
    return std::unexpected(DamagedIndex(name, fmt::format("a credential of the kind \"{}\"", row.Text(first + 2))));
  }
  return Credential{.id = row.Integer(first),
                    .account = row.Integer(first + 1),
                    .kind = *kind,
                    .label = row.Text(first + 3),
                    .created_utc_us = row.Integer(first + 4),
                    .expires_utc_us = row.Integer(first + 5)};
}

class SqlAccountStore final : public AccountStore {
 public:
  explicit SqlAccountStore(std::unique_ptr<Database> database)
      : database_(std::move(database)),
        has_name_(fmt::format("{} = {}", Lower(database_->dialect(), "name"), Lower(database_->dialect(), "?"))) {}

  Expected<Account> Add(const std::string& name, Role role, const std::string& password_hash,
                        std::int64_t now_us) override {
    VICTORIOUS_RETURN_IF_ERROR(CheckAccountName(name));
    VICTORIOUS_RETURN_IF_ERROR(database_->HideFromOthers());
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Account> known, Find(name));
    if (known) {
      return Fail(ErrorCode::kAlreadyExists,
                  fmt::format("{}: there is an account {} already", database_->name(), known->name));
    }
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::int64_t id,
        database_->ReadInteger(
            "INSERT INTO accounts (name, role, password_hash, created_utc_us) VALUES (?, ?, ?, ?) RETURNING id",
            ValueList(name, ToText(role), password_hash, now_us)));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return Account{.id = id, .name = name, .role = role, .created_utc_us = now_us};
  }

  Status SetRole(const std::string& name, Role role) override {
    return WriteOnAccount("UPDATE accounts SET role = ? WHERE " + has_name_, ValueList(ToText(role), name), name);
  }

  Status SetPassword(const std::string& name, const std::string& password_hash) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_RETURN_IF_ERROR(WriteOnAccount("UPDATE accounts SET password_hash = ? WHERE " + has_name_,
                                              ValueList(password_hash, name), name));
    VICTORIOUS_RETURN_IF_ERROR(database_->Write(
        fmt::format("DELETE FROM credentials WHERE account_id = (SELECT id FROM accounts WHERE {})", has_name_),
        ValueList(name)));
    return change.Commit();
  }

  Status Remove(const std::string& name) override {
    return WriteOnAccount("DELETE FROM accounts WHERE " + has_name_, ValueList(name), name);
  }

  Expected<std::vector<Account>> Accounts() override {
    return database_->ReadAll(fmt::format("{}ORDER BY {}", kSelectAccounts, Lower(database_->dialect(), "name")),
                              ValueList(), [&](const Row& row) { return ReadAccount(row, database_->name()); });
  }

  Expected<bool> HasAccounts() override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const auto first, database_->ReadOne(fmt::format("{}LIMIT 1", kSelectAccounts), ValueList(),
                                             [&](const Row& row) { return ReadAccount(row, database_->name()); }));
    return first.has_value();
  }

  Expected<std::optional<Account>> Find(const std::string& name) override {
    return database_->ReadOne(fmt::format("{}WHERE {}", kSelectAccounts, has_name_), ValueList(name),
                              [&](const Row& row) { return ReadAccount(row, database_->name()); });
  }

  Expected<std::string> PasswordHash(std::int64_t account) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        std::optional<std::string> hash,
        database_->ReadOne("SELECT password_hash FROM accounts WHERE id = ?", ValueList(account),
                           [](const Row& row) -> Expected<std::string> { return row.Text(0); }));
    if (hash) return *std::move(hash);
    return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no account {}", database_->name(), account));
  }

  Expected<Credential> AddCredential(const NewCredential& added) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string hash, PasswordHash(added.account));
    if (added.proved_hash && *added.proved_hash != hash) {
      return Fail(ErrorCode::kConflict, fmt::format("{}: the password of the account {} has changed meanwhile",
                                                    database_->name(), added.account));
    }
    Credential credential{.account = added.account,
                          .kind = added.kind,
                          .label = added.label,
                          .created_utc_us = added.now_us,
                          .expires_utc_us = added.now_us + added.lifetime_us};
    VICTORIOUS_RETURN_IF_ERROR(RemoveExpired(added.now_us));
    if (added.kind == CredentialKind::kSession) VICTORIOUS_RETURN_IF_ERROR(MakeRoomForSession(added.account));
    VICTORIOUS_ASSIGN_OR_RETURN(
        credential.id,
        database_->ReadInteger("INSERT INTO credentials (account_id, kind, digest, label, created_utc_us, "
                               "expires_utc_us) VALUES (?, ?, ?, ?, ?, ?) RETURNING id",
                               ValueList(added.account, ToText(added.kind), added.digest, added.label, added.now_us,
                                         credential.expires_utc_us)));
    VICTORIOUS_RETURN_IF_ERROR(change.Commit());
    return credential;
  }

  Expected<std::optional<ProvedAccount>> Prove(const std::string& digest, std::int64_t now_us) override {
    return database_->ReadOne(
        "SELECT a.id, a.name, a.role, a.created_utc_us, c.id, c.account_id, c.kind, c.label, c.created_utc_us, "
        "c.expires_utc_us FROM credentials c JOIN accounts a ON a.id = c.account_id WHERE c.digest = ? AND "
        "c.expires_utc_us > ?",
        ValueList(digest, now_us), [&](const Row& row) -> Expected<ProvedAccount> {
          ProvedAccount proved;
          VICTORIOUS_ASSIGN_OR_RETURN(proved.account, ReadAccount(row, database_->name()));
          VICTORIOUS_ASSIGN_OR_RETURN(proved.credential, ReadCredential(row, 4, database_->name()));
          return proved;
        });
  }

  Status RemoveExpired(std::int64_t now_us) override {
    const auto removed = database_->Write("DELETE FROM credentials WHERE expires_utc_us <= ?", ValueList(now_us));
    if (!removed) return std::unexpected(removed.error());
    return {};
  }

  Expected<std::int64_t> CountSessions(std::int64_t now_us) override {
    return database_->ReadInteger("SELECT count(*) FROM credentials WHERE kind = 'session' AND expires_utc_us > ?",
                                  ValueList(now_us));
  }

  Status RemoveCredential(std::int64_t account, std::int64_t credential) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        const std::int64_t removed,
        database_->Write("DELETE FROM credentials WHERE id = ? AND account_id = ?", ValueList(credential, account)));
    if (removed == 1) return {};
    return Fail(ErrorCode::kNotFound, fmt::format("{}: the account has no token {}", database_->name(), credential));
  }

  Expected<std::vector<Credential>> Tokens(std::int64_t account) override {
    return database_->ReadAll(
        "SELECT id, account_id, kind, label, created_utc_us, expires_utc_us FROM credentials WHERE account_id = ? AND "
        "kind = 'token' ORDER BY id",
        ValueList(account), [&](const Row& row) { return ReadCredential(row, 0, database_->name()); });
  }

  Status Log(const AuditRecord& record) override { return AddAudit(*database_, record); }

  Status ChangeAndLog(const std::function<Expected<AuditRecord>()>& make) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Change change, Change::Begin(*database_));
    VICTORIOUS_ASSIGN_OR_RETURN(const AuditRecord record, make());
    VICTORIOUS_RETURN_IF_ERROR(Log(record));
    return change.Commit();
  }

  Expected<std::vector<AuditRecord>> Audit(std::int64_t limit, std::optional<std::int64_t> before) override {
    return database_->ReadAll(
        "SELECT id, time_utc_us, actor, action, subject, detail FROM audit WHERE id < ? ORDER BY id DESC LIMIT ?",
        ValueList(before.value_or(INT64_MAX), limit), [](const Row& row) -> Expected<AuditRecord> {
          return AuditRecord{.id = row.Integer(0),
                             .time_utc_us = row.Integer(1),
                             .actor = row.Text(2),
                             .action = row.Text(3),
                             .subject = row.Text(4),
                             .detail = row.Text(5)};
        });
  }

 private:
  // Browsers that are closed without a log-out leave their sessions.
  Status MakeRoomForSession(std::int64_t account) {
    const auto ended = database_->Write(
        "DELETE FROM credentials WHERE account_id = ? AND kind = 'session' AND id NOT IN (SELECT id FROM credentials "
        "WHERE account_id = ? AND kind = 'session' ORDER BY id DESC LIMIT ?)",
        ValueList(account, account, kMaxSessions - 1));
    if (!ended) return std::unexpected(ended.error());
    return {};
  }

  // Runs a statement that must change the row of one account.
  Status WriteOnAccount(const std::string& sql, const ValueList& values, const std::string& name) {
    VICTORIOUS_ASSIGN_OR_RETURN(const std::int64_t changed, database_->Write(sql, values));
    if (changed == 1) return {};
    return Fail(ErrorCode::kNotFound,
                fmt::format("{}: there is no account {}: `victorious user list` lists them", database_->name(), name));
  }

  std::unique_ptr<Database> database_;
  std::string has_name_;  ///< condition; its parameter is a name
};

}  // namespace
}  // namespace victorious::sql

namespace victorious {

Status CheckAccountName(std::string_view name) {
  constexpr std::size_t kMaxLength = 64;
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
  };
  const bool is_valid =
      !name.empty() && name.size() <= kMaxLength && is_letter(name.front()) &&
      std::ranges::all_of(name, [&](char c) { return is_letter(c) || c == '.' || c == '_' || c == '-' || c == '@'; });
  if (is_valid) return {};
  return Fail(ErrorCode::kInvalidArgument,
              "the name of an account must be 1 to 64 letters a to z, digits or . _ - @, and begin with a letter or "
              "digit");
}

Expected<std::unique_ptr<AccountStore>> OpenAccountStore(const std::string& name, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto database, sql::OpenDatabase(name, mode));
  return std::make_unique<sql::SqlAccountStore>(std::move(database));
}

}  // namespace victorious
