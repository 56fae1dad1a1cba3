// AccountStore in the SQLite file of an index.
#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "victorious/store/account_store.h"
#include "victorious/store/sqlite/open_database.h"

namespace victorious::sqlite {
namespace {

Expected<Account> ReadAccount(const Statement& row, std::string_view name) {
  const auto role = FromText(kRoleTexts, row.Text(2));
  if (!role) return std::unexpected(DamagedIndex(name, fmt::format("an account with the role \"{}\"", row.Text(2))));
  return Account{.id = row.Integer(0), .name = row.Text(1), .role = *role, .created_utc_us = row.Integer(3)};
}

// Columns id, account_id, kind, label, created_utc_us, expires_utc_us from `first` on.
Expected<Credential> ReadCredential(const Statement& row, int first, std::string_view name) {
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

// A transaction, or a part of the one that has begun.
class Step {
 public:
  static Expected<Step> Begin(Connection& connection) {
    Step step;
    if (connection.IsInTransaction()) return step;
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(connection));
    step.transaction_.emplace(std::move(transaction));
    return step;
  }
  Status Commit() { return transaction_ ? transaction_->Commit() : Status(); }

 private:
  std::optional<Transaction> transaction_;
};

class SqliteAccountStore final : public AccountStore {
 public:
  explicit SqliteAccountStore(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

  Expected<Account> Add(const std::string& name, Role role, const std::string& password_hash,
                        std::int64_t now_us) override {
    VICTORIOUS_RETURN_IF_ERROR(CheckAccountName(name));
    VICTORIOUS_ASSIGN_OR_RETURN(Step step, Step::Begin(*connection_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::optional<Account> known, Find(name));
    if (known) {
      return Fail(ErrorCode::kAlreadyExists,
                  fmt::format("{}: there is an account {} already", connection_->name(), known->name));
    }
    {
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement insert,
          connection_->Prepare("INSERT INTO accounts (name, role, password_hash, created_utc_us) VALUES (?, ?, ?, ?)"));
      VICTORIOUS_RETURN_IF_ERROR(insert.Bind(name, ToText(role), password_hash, now_us).Run());
    }
    Account account{.id = connection_->LastInsertId(), .name = name, .role = role, .created_utc_us = now_us};
    VICTORIOUS_RETURN_IF_ERROR(step.Commit());
    return account;
  }

  Status SetRole(const std::string& name, Role role) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement update, connection_->Prepare("UPDATE accounts SET role = ? WHERE name = ?"));
    update.Bind(ToText(role), name);
    return RunOnAccount(update, name);
  }

  Status SetPassword(const std::string& name, const std::string& password_hash) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Step step, Step::Begin(*connection_));
    {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement update,
                                  connection_->Prepare("UPDATE accounts SET password_hash = ? WHERE name = ?"));
      update.Bind(password_hash, name);
      VICTORIOUS_RETURN_IF_ERROR(RunOnAccount(update, name));
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement end, connection_->Prepare("DELETE FROM credentials WHERE account_id = (SELECT id FROM accounts "
                                              "WHERE name = ?)"));
      VICTORIOUS_RETURN_IF_ERROR(end.Bind(name).Run());
    }
    return step.Commit();
  }

  Status Remove(const std::string& name) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement remove, connection_->Prepare("DELETE FROM accounts WHERE name = ?"));
    remove.Bind(name);
    return RunOnAccount(remove, name);
  }

  Expected<std::vector<Account>> Accounts() override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare("SELECT id, name, role, created_utc_us FROM accounts ORDER BY name"));
    std::vector<Account> accounts;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return accounts;
      VICTORIOUS_ASSIGN_OR_RETURN(Account account, ReadAccount(select, connection_->name()));
      accounts.push_back(std::move(account));
    }
  }

  Expected<bool> HasAccounts() override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select, connection_->Prepare("SELECT 1 FROM accounts LIMIT 1"));
    return select.Step();
  }

  Expected<std::optional<Account>> Find(const std::string& name) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select, connection_->Prepare("SELECT id, name, role, created_utc_us FROM accounts WHERE name = ?"));
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(name).Step());
    if (!found) return std::nullopt;
    VICTORIOUS_ASSIGN_OR_RETURN(Account account, ReadAccount(select, connection_->name()));
    return account;
  }

  Expected<std::string> PasswordHash(std::int64_t account) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement select,
                                connection_->Prepare("SELECT password_hash FROM accounts WHERE id = ?"));
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(account).Step());
    if (!found) return NoAccount(account);
    return select.Text(0);
  }

  Expected<Credential> AddCredential(const NewCredential& added) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Step step, Step::Begin(*connection_));
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string hash, PasswordHash(added.account));
    if (added.proved_hash && *added.proved_hash != hash) {
      return Fail(ErrorCode::kConflict, fmt::format("{}: the password of the account {} has changed meanwhile",
                                                    connection_->name(), added.account));
    }
    Credential credential{.account = added.account,
                          .kind = added.kind,
                          .label = added.label,
                          .created_utc_us = added.now_us,
                          .expires_utc_us = added.now_us + added.lifetime_us};
    {
      VICTORIOUS_ASSIGN_OR_RETURN(Statement expire,
                                  connection_->Prepare("DELETE FROM credentials WHERE expires_utc_us <= ?"));
      VICTORIOUS_RETURN_IF_ERROR(expire.Bind(added.now_us).Run());
      if (added.kind == CredentialKind::kSession) VICTORIOUS_RETURN_IF_ERROR(MakeRoomForSession(added.account));
      VICTORIOUS_ASSIGN_OR_RETURN(
          Statement insert,
          connection_->Prepare("INSERT INTO credentials (account_id, kind, digest, label, created_utc_us, "
                               "expires_utc_us) VALUES (?, ?, ?, ?, ?, ?)"));
      insert.Bind(added.account, ToText(added.kind), added.digest, added.label, added.now_us,
                  credential.expires_utc_us);
      VICTORIOUS_RETURN_IF_ERROR(insert.Run());
    }
    credential.id = connection_->LastInsertId();
    VICTORIOUS_RETURN_IF_ERROR(step.Commit());
    return credential;
  }

  Expected<std::optional<ProvedAccount>> Prove(const std::string& digest, std::int64_t now_us) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT a.id, a.name, a.role, a.created_utc_us, c.id, c.account_id, c.kind, c.label, "
                             "c.created_utc_us, c.expires_utc_us FROM credentials c JOIN accounts a "
                             "ON a.id = c.account_id WHERE c.digest = ? AND c.expires_utc_us > ?"));
    VICTORIOUS_ASSIGN_OR_RETURN(const bool found, select.Bind(digest, now_us).Step());
    if (!found) return std::nullopt;
    ProvedAccount proved;
    VICTORIOUS_ASSIGN_OR_RETURN(proved.account, ReadAccount(select, connection_->name()));
    VICTORIOUS_ASSIGN_OR_RETURN(proved.credential, ReadCredential(select, 4, connection_->name()));
    return proved;
  }

  Status RemoveCredential(std::int64_t account, std::int64_t credential) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Statement remove,
                                connection_->Prepare("DELETE FROM credentials WHERE id = ? AND account_id = ?"));
    VICTORIOUS_RETURN_IF_ERROR(remove.Bind(credential, account).Run());
    if (connection_->Changes() == 1) return {};
    return Fail(ErrorCode::kNotFound, fmt::format("{}: the account has no token {}", connection_->name(), credential));
  }

  Expected<std::vector<Credential>> Tokens(std::int64_t account) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT id, account_id, kind, label, created_utc_us, expires_utc_us FROM credentials "
                             "WHERE account_id = ? AND kind = 'token' ORDER BY id"));
    select.Bind(account);
    std::vector<Credential> tokens;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return tokens;
      VICTORIOUS_ASSIGN_OR_RETURN(Credential token, ReadCredential(select, 0, connection_->name()));
      tokens.push_back(std::move(token));
    }
  }

  Status Log(const AuditRecord& record) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement insert,
        connection_->Prepare("INSERT INTO audit (time_utc_us, actor, action, subject, detail) VALUES (?, ?, ?, ?, ?)"));
    return insert.Bind(record.time_utc_us, record.actor, record.action, record.subject, record.detail).Run();
  }

  Status ChangeAndLog(const std::function<Expected<AuditRecord>()>& change) override {
    VICTORIOUS_ASSIGN_OR_RETURN(Transaction transaction, Transaction::Begin(*connection_));
    VICTORIOUS_ASSIGN_OR_RETURN(const AuditRecord record, change());
    VICTORIOUS_RETURN_IF_ERROR(Log(record));
    return transaction.Commit();
  }

  Expected<std::vector<AuditRecord>> Audit(std::int64_t limit, std::optional<std::int64_t> before) override {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement select,
        connection_->Prepare("SELECT id, time_utc_us, actor, action, subject, detail FROM audit WHERE id < ? "
                             "ORDER BY id DESC LIMIT ?"));
    select.Bind(before.value_or(INT64_MAX), limit);
    std::vector<AuditRecord> records;
    while (true) {
      VICTORIOUS_ASSIGN_OR_RETURN(const bool has_row, select.Step());
      if (!has_row) return records;
      records.push_back({.id = select.Integer(0),
                         .time_utc_us = select.Integer(1),
                         .actor = select.Text(2),
                         .action = select.Text(3),
                         .subject = select.Text(4),
                         .detail = select.Text(5)});
    }
  }

 private:
  // Browsers that are closed without a log-out leave their sessions.
  Status MakeRoomForSession(std::int64_t account) {
    VICTORIOUS_ASSIGN_OR_RETURN(
        Statement end,
        connection_->Prepare("DELETE FROM credentials WHERE account_id = ?1 AND kind = 'session' AND id NOT IN (SELECT "
                             "id FROM credentials WHERE account_id = ?1 AND kind = 'session' ORDER BY id DESC "
                             "LIMIT ?2)"));
    return end.Bind(account, kMaxSessions - 1).Run();
  }

  // Runs a statement that must change the row of one account.
  Status RunOnAccount(Statement& statement, const std::string& name) {
    VICTORIOUS_RETURN_IF_ERROR(statement.Run());
    if (connection_->Changes() == 1) return {};
    return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no account {}: `victorious user list` lists them",
                                                  connection_->name(), name));
  }

  [[nodiscard]] std::unexpected<Error> NoAccount(std::int64_t account) const {
    return Fail(ErrorCode::kNotFound, fmt::format("{}: there is no account {}", connection_->name(), account));
  }

  std::unique_ptr<Connection> connection_;
};

}  // namespace
}  // namespace victorious::sqlite

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

Expected<std::unique_ptr<AccountStore>> OpenSqliteAccountStore(const std::filesystem::path& path, StoreMode mode) {
  VICTORIOUS_ASSIGN_OR_RETURN(auto connection, sqlite::OpenDatabase(path, mode));
  return std::make_unique<sqlite::SqliteAccountStore>(std::move(connection));
}

}  // namespace victorious
