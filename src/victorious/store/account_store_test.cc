// The contract of AccountStore, tested for every implementation.
#include "victorious/store/account_store.h"

#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "testing/data.h"
#include "testing/scratch_postgres.h"
#include "victorious/store/open_store.h"

namespace victorious {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::int64_t kHour = 3'600'000'000;

class AccountStoreTest : public ::testing::TestWithParam<testing::StoreKind> {
 protected:
  void SetUp() override {
    VICTORIOUS_STORE_OR_SKIP(name_, GetParam().make(folder_.path()));
    accounts_ = Open();
    other_ = Open();
  }

  std::unique_ptr<AccountStore> Open() {
    auto store = OpenAccountStore(name_, StoreMode::kCreate);
    EXPECT_TRUE(store) << store.error().message;
    return *std::move(store);
  }

  testing::ScratchFolder folder_;
  std::string name_;
  std::unique_ptr<AccountStore> accounts_;
  std::unique_ptr<AccountStore> other_;  // of another process
};

TEST_P(AccountStoreTest, AccountsAreAddedChangedAndRemoved) {
  EXPECT_FALSE(*accounts_->HasAccounts());
  const auto ann = accounts_->Add("Ann", Role::kAnalyst, "hash 1", 10);
  ASSERT_TRUE(ann) << ann.error().message;
  ASSERT_TRUE(accounts_->Add("bob", Role::kViewer, "hash 2", 11));
  EXPECT_TRUE(*other_->HasAccounts());
  EXPECT_EQ(accounts_->Add("ANN", Role::kAdmin, "", 12).error().code, ErrorCode::kAlreadyExists)
      << "two names that people take for one";
  const auto found = other_->Find("ann");
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->name, "Ann");
  EXPECT_EQ((*found)->role, Role::kAnalyst);
  EXPECT_EQ((*found)->created_utc_us, 10);
  EXPECT_EQ(*other_->PasswordHash(ann->id), "hash 1");

  ASSERT_TRUE(accounts_->SetRole("ann", Role::kAdmin));
  ASSERT_TRUE(accounts_->SetPassword("ann", "hash 3"));
  EXPECT_EQ((*other_->Find("Ann"))->role, Role::kAdmin);
  EXPECT_EQ(*other_->PasswordHash(ann->id), "hash 3");
  ASSERT_TRUE(accounts_->Remove("ann"));
  EXPECT_FALSE(*accounts_->Find("Ann"));
  EXPECT_THAT(*accounts_->Accounts(), SizeIs(1));
  for (const Status& status :
       {accounts_->Remove("ann"), accounts_->SetRole("ann", Role::kViewer), accounts_->SetPassword("ann", "")}) {
    EXPECT_EQ(status.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(status.error().message, HasSubstr("ann"));
  }
  EXPECT_NE(accounts_->Add("ann", Role::kViewer, "", 20)->id, ann->id) << "an id is never another account's";
}

// Hashes of passwords are tried out by whoever can read them.
TEST(AccountStore, FileWithPasswordsIsOfItsUser) {
  const testing::ScratchFolder folder;
  const std::filesystem::path index = folder / "index.db";
  const auto accounts = OpenAccountStore(index, StoreMode::kCreate).value();
  std::filesystem::permissions(index, std::filesystem::perms(0644));
  ASSERT_TRUE(accounts->Add("ann", Role::kAdmin, "h", 1));
  for (const char* const suffix : {"", "-wal"}) {
    EXPECT_EQ(std::filesystem::status(index.string() + suffix).permissions(), std::filesystem::perms(0600)) << suffix;
  }
}

TEST_P(AccountStoreTest, NamesAreOfAFewCharacters) {
  for (const std::string name : {"a", "Ann.Lee-2_x@example.org", "0"}) EXPECT_TRUE(CheckAccountName(name)) << name;
  for (const std::string name : {"", " ann", "ann lee", ".ann", "an\nn", "\xc3\xa4nn", "a/b", "-x"}) {
    EXPECT_FALSE(CheckAccountName(name)) << name;
    EXPECT_EQ(accounts_->Add(name, Role::kViewer, "", 1).error().code, ErrorCode::kInvalidArgument) << name;
  }
  EXPECT_TRUE(CheckAccountName(std::string(64, 'a')));
  EXPECT_FALSE(CheckAccountName(std::string(65, 'a')));
}

TEST_P(AccountStoreTest, CredentialsProveTheirAccountUntilTheyEnd) {
  const std::int64_t ann = accounts_->Add("ann", Role::kAnalyst, "h", 1)->id;
  const std::int64_t bob = accounts_->Add("bob", Role::kViewer, "h", 1)->id;
  const auto session = accounts_->AddCredential({.account = ann,
                                                 .kind = CredentialKind::kSession,
                                                 .digest = "digest a",
                                                 .label = "",
                                                 .now_us = 100,
                                                 .lifetime_us = kHour});
  ASSERT_TRUE(session) << session.error().message;
  ASSERT_TRUE(accounts_->AddCredential({.account = bob,
                                        .kind = CredentialKind::kToken,
                                        .digest = "digest b",
                                        .label = "nightly",
                                        .now_us = 100,
                                        .lifetime_us = 9 * kHour}));
  const auto proved = other_->Prove("digest a", 100 + kHour - 1);
  ASSERT_TRUE(proved && *proved);
  EXPECT_EQ((*proved)->account.name, "ann");
  EXPECT_EQ((*proved)->credential.id, session->id);
  EXPECT_EQ((*proved)->credential.kind, CredentialKind::kSession);
  EXPECT_FALSE(*other_->Prove("digest a", 100 + kHour)) << "expired";
  EXPECT_FALSE(*other_->Prove("digest c", 100));
  EXPECT_FALSE(*other_->Prove("", 100));

  ASSERT_TRUE(accounts_->RemoveExpired(100 + kHour));
  EXPECT_FALSE(*other_->Prove("digest a", 100)) << "deleted: no clock that is set back brings it back";

  ASSERT_THAT(*accounts_->Tokens(bob), SizeIs(1));
  EXPECT_EQ(accounts_->Tokens(bob)->front().label, "nightly");
  EXPECT_THAT(*accounts_->Tokens(ann), SizeIs(0)) << "a session is no token";
  const std::int64_t token = accounts_->Tokens(bob)->front().id;
  EXPECT_EQ(accounts_->RemoveCredential(ann, token).error().code, ErrorCode::kNotFound) << "bob's";
  ASSERT_TRUE(accounts_->RemoveCredential(bob, token));
  EXPECT_FALSE(*other_->Prove("digest b", 101));

  ASSERT_TRUE(accounts_->SetPassword("ann", "h2"));
  EXPECT_FALSE(*other_->Prove("digest a", 101)) << "another password ends the sessions";
  ASSERT_TRUE(accounts_->AddCredential({.account = ann,
                                        .kind = CredentialKind::kSession,
                                        .digest = "digest d",
                                        .label = "",
                                        .now_us = 100,
                                        .lifetime_us = kHour}));
  ASSERT_TRUE(accounts_->Remove("ann"));
  EXPECT_FALSE(*other_->Prove("digest d", 101));
  EXPECT_EQ(accounts_
                ->AddCredential({.account = ann,
                                 .kind = CredentialKind::kSession,
                                 .digest = "digest e",
                                 .label = "",
                                 .now_us = 100,
                                 .lifetime_us = kHour})
                .error()
                .code,
            ErrorCode::kNotFound);
}

TEST_P(AccountStoreTest, FormerPasswordGivesNoSession) {
  const std::int64_t ann = accounts_->Add("ann", Role::kAnalyst, "h1", 1)->id;
  NewCredential session{.account = ann, .digest = "a", .now_us = 100, .lifetime_us = kHour, .proved_hash = "h1"};
  ASSERT_TRUE(accounts_->AddCredential(session));
  ASSERT_TRUE(other_->SetPassword("ann", "h2"));
  session.digest = "b";
  const auto late = accounts_->AddCredential(session);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::kConflict);
  EXPECT_FALSE(*other_->Prove("b", 101));
  session.proved_hash = "h2";
  ASSERT_TRUE(accounts_->AddCredential(session));
  EXPECT_TRUE(*other_->Prove("b", 101));
}

TEST_P(AccountStoreTest, SessionsOfAnAccountAreLimited) {
  const std::int64_t ann = accounts_->Add("ann", Role::kAnalyst, "h", 1)->id;
  const std::int64_t bob = accounts_->Add("bob", Role::kAnalyst, "h", 1)->id;
  const auto add = [&](std::int64_t account, CredentialKind kind, const std::string& digest) {
    return accounts_->AddCredential(
        {.account = account, .kind = kind, .digest = digest, .now_us = 100, .lifetime_us = kHour});
  };
  ASSERT_TRUE(add(bob, CredentialKind::kSession, "bob's"));
  ASSERT_TRUE(add(ann, CredentialKind::kToken, "token"));
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(add(ann, CredentialKind::kSession, std::to_string(i)));
  for (int i = 0; i < 25; ++i) EXPECT_EQ(other_->Prove(std::to_string(i), 101)->has_value(), i >= 5) << i;
  EXPECT_TRUE(*other_->Prove("bob's", 101));
  EXPECT_TRUE(*other_->Prove("token", 101));
}

TEST_P(AccountStoreTest, LogIsReadFromTheLatestEntry) {
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(accounts_->Log(
        {.time_utc_us = 10 + i, .actor = "ann", .action = "upload", .subject = std::to_string(i), .detail = "{}"}));
  }
  const auto latest = other_->Audit(2, std::nullopt);
  ASSERT_TRUE(latest) << latest.error().message;
  ASSERT_THAT(*latest, SizeIs(2));
  EXPECT_EQ(latest->front().subject, "4");
  EXPECT_EQ(latest->front().time_utc_us, 14);
  const auto next = other_->Audit(10, latest->back().id);
  ASSERT_THAT(*next, SizeIs(3));
  EXPECT_EQ(next->front().subject, "2");
}

TEST_P(AccountStoreTest, AChangeAndItsEntryAreOneTransaction) {
  const auto entry = [](std::string subject) {
    return AuditRecord{.time_utc_us = 5, .actor = "x", .action = "add_account", .subject = std::move(subject)};
  };
  std::int64_t ann = 0;
  ASSERT_TRUE(accounts_->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_ASSIGN_OR_RETURN(const Account added, accounts_->Add("ann", Role::kAnalyst, "h", 1));
    ann = added.id;
    EXPECT_FALSE(*other_->Find("ann")) << "not before its entry";
    return entry("account ann");
  }));
  EXPECT_EQ((*other_->Find("ann"))->id, ann);
  const Status failed = accounts_->ChangeAndLog([&]() -> Expected<AuditRecord> {
    VICTORIOUS_RETURN_IF_ERROR(accounts_->Add("bob", Role::kViewer, "h", 1));
    VICTORIOUS_RETURN_IF_ERROR(accounts_->SetPassword("ann", "h2"));
    VICTORIOUS_RETURN_IF_ERROR(accounts_->Remove("nobody"));
    return entry("account bob");
  });
  EXPECT_EQ(failed.error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(*other_->Find("bob")) << "what went before the failure is taken back";
  EXPECT_EQ(*other_->PasswordHash(ann), "h");
  const auto log = other_->Audit(10, std::nullopt);
  ASSERT_THAT(*log, SizeIs(1));
  EXPECT_EQ(log->front().subject, "account ann");
  ASSERT_TRUE(accounts_->SetRole("ann", Role::kAdmin)) << "the store goes on";
}

// A review and its entry in the log are one transaction.
TEST_P(AccountStoreTest, ReviewsAreInTheLog) {
  const auto store = OpenStore(name_, StoreMode::kCreate).value();
  const std::int64_t video = store->PutVideo({.content_id = "c1", .name = "a.mp4", .width = 640, .height = 480})->id;
  const std::int64_t model = store->PutModel({.name = "jeep", .content_id = "m1"})->id;
  IndexBatch batch;
  batch.tracklets.push_back({std::nullopt, {.video = video, .model = model, .score = 0.5, .frames = 1}});
  batch.sightings.push_back({0, {.frame = 7, .box = {1, 2, 30, 40}, .score = 0.5, .matches = 9}});
  const std::int64_t object = store->Commit(batch)->front();
  ASSERT_TRUE(store->PutReview(object, {Verdict::kRejected, "a \"shed\"", 20, "ann"}));
  ASSERT_TRUE(store->PutReview(object, {std::nullopt, "", 30, "bob"}));
  EXPECT_FALSE(store->PutReview(999, {Verdict::kRejected, "", 40, "eve"}));
  const auto log = accounts_->Audit(10, std::nullopt);
  ASSERT_THAT(*log, SizeIs(2)) << "what was refused was not decided";
  EXPECT_EQ(log->front().actor, "bob");
  EXPECT_THAT(log->front().detail, HasSubstr(R"("verdict":null)"));
  EXPECT_EQ(log->back().actor, "ann");
  EXPECT_EQ(log->back().action, "review");
  EXPECT_EQ(log->back().time_utc_us, 20);
  EXPECT_EQ(log->back().subject, "object " + std::to_string(object));
  EXPECT_EQ(log->back().detail, R"({"verdict":"rejected","note":"a \"shed\"","model":"jeep","video":"c1","frame":7})");
}

VICTORIOUS_TEST_ON_ALL_STORES(AccountStoreTest);

}  // namespace
}  // namespace victorious
