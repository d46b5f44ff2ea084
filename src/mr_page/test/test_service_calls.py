"""Services that answer, and such as do not."""

import threading

from mr_page.commands import Answer
from mr_page.service_calls import ServiceCalls


def test_a_service_that_hangs_is_given_up_and_not_called_again_until_it_answers():
    calls, hangs, called = ServiceCalls(0.2), threading.Event(), []

    def hang():
        called.append("hang")
        hangs.wait()
        return Answer(True, "too late")

    answer = calls.answer("pause", hang)
    assert not answer.done and answer.text.startswith("the service pause does not answer within 0.2 s")
    assert "has not answered an earlier call" in calls.answer("pause", hang).text and called == ["hang"]
    assert calls.answer("stop", lambda: Answer(True, "stopped")) == (True, "stopped")
    hangs.set()
    while "earlier call" in (again := calls.answer("pause", lambda: Answer(True, "paused"))).text:
        pass
    assert again == (True, "paused")
