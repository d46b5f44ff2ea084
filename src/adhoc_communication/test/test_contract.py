"""Messages and services are those of the contract: MD5 sums of all 32 types."""

import json
from pathlib import Path

import pytest
import roslib.message

CONTRACT = json.loads((Path(__file__).parent / "contract_md5.json").read_text())


def test_contract_lists_14_messages_and_18_services():
    services = [name for name in CONTRACT if roslib.message.get_service_class(f"adhoc_communication/{name}")]
    assert (len(CONTRACT) - len(services), len(services)) == (14, 18)


@pytest.mark.parametrize("name", sorted(CONTRACT))
def test_md5_sum(name):
    full_name = f"adhoc_communication/{name}"
    generated = roslib.message.get_message_class(full_name) or roslib.message.get_service_class(full_name)
    assert generated._md5sum == CONTRACT[name]
