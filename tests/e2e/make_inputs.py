"""Makes anew what most end-to-end tests read: a flight, a model library of its objects, an index. The ctest e2e/inputs."""

import shutil
import sys

import program

if not program.INPUTS:
    sys.exit("VICTORIOUS_E2E_INPUTS is not set: the folder to make")
shutil.rmtree(program.INPUTS, ignore_errors=True)
program.INPUTS.mkdir(parents=True)
flight = program.INPUTS / "flight"
flight.mkdir()
program.make_flight(flight)
models = program.make_models(flight, program.INPUTS / "models")
program.make_index(flight, models, program.INPUTS / "index.db")
