# For those who develop; users need only pip. First: pip install -e ".[dev]"
.PHONY: format check test slow docs ci

format:
	ruff check --fix .
	ruff format .

check:
	ruff check .
	ruff format --check .
	mypy

test:
	pytest

slow:
	pytest -m slow

docs:
	python docs/generate.py

ci:
	./.ci/run
