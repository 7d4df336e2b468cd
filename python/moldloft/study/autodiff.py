"""Functions of models in programs that differentiate: JAX and PyTorch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from moldloft.errors import Error
from moldloft.study.extras import needed
from moldloft.study.functions import Function

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["jax_function", "torch_function"]


def jax_function(function: Function) -> Callable[[Any], Any]:
    """A JAX function with its gradient in reverse mode.

    Parameters
    ----------
    function
        Made by :func:`moldloft.study.function`.

    Returns
    -------
    callable
        Takes an array of the inputs, ``(inputs,)``, and returns the outputs, ``(outputs,)``;
        `jax.grad`, `jax.vjp`, `jax.jacrev`, `jax.jit` and `jax.vmap` take it.

    Raises
    ------
    MissingPackageError
        If JAX is not installed.
    Error
        If JAX computes in single precision.

    Notes
    -----
    It calls back to this process, which evaluates one point after the other.
    """
    jax = needed("jax", "jax", "a function of JAX")
    if not jax.config.jax_enable_x64:
        raise Error(
            "JAX computes in single precision: set JAX_ENABLE_X64=1, or call "
            'jax.config.update("jax_enable_x64", True) before anything else'
        )
    size, inputs = sum(function.sizes.values()), len(function.inputs)
    double = np.dtype(np.float64)
    values = jax.ShapeDtypeStruct((size,), double)
    gradients = jax.ShapeDtypeStruct((inputs,), double)

    def evaluate(x: Any) -> Any:
        return np.asarray(function(np.asarray(x)))

    def pull(x: Any, weights: Any) -> Any:
        return np.asarray(function.vjp(np.asarray(x), np.asarray(weights)))

    def called(x: Any) -> Any:
        return jax.pure_callback(evaluate, values, x, vmap_method="sequential")

    outputs: Any = jax.custom_vjp(called)

    def forward(x: Any) -> tuple[Any, Any]:
        return outputs(x), x

    def backward(x: Any, weights: Any) -> tuple[Any]:
        found = jax.pure_callback(pull, gradients, x, weights, vmap_method="sequential")
        return (found,)

    outputs.defvjp(forward, backward)
    return lambda x: outputs(jax.numpy.asarray(x, dtype=double))


def torch_function(function: Function) -> Callable[[Any], Any]:
    """A PyTorch function with its gradient in reverse mode.

    Parameters
    ----------
    function
        Made by :func:`moldloft.study.function`.

    Returns
    -------
    callable
        Takes a tensor of the inputs, ``(inputs,)``, and returns the outputs, ``(outputs,)``, in
        its precision and on its device.

    Raises
    ------
    MissingPackageError
        If PyTorch is not installed.
    """
    torch = needed("torch", "torch", "a function of PyTorch")
    once = needed("torch.autograd.function", "torch", "a function of PyTorch")

    def plain(x: Any) -> Any:
        return x.detach().cpu().numpy().astype(np.float64)

    def forward(ctx: Any, x: Any) -> Any:
        ctx.save_for_backward(x)
        return torch.as_tensor(function(plain(x)), dtype=x.dtype, device=x.device)

    def backward(ctx: Any, weights: Any) -> Any:
        (x,) = ctx.saved_tensors
        found = function.vjp(plain(x), plain(weights))
        return torch.as_tensor(found, dtype=x.dtype, device=x.device)

    members = {
        "forward": staticmethod(forward),
        "backward": staticmethod(once.once_differentiable(backward)),
    }
    made: Any = type("Outputs", (torch.autograd.Function,), members)
    return lambda x: made.apply(x)
