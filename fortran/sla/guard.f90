!> Residuals of the displacements by the elements themselves, and what is done where they have grown.
module sla_guard
   use common_kinds, only : wp
   use common_status, only : status_ok
   use sla_c_bindings, only : extrados_sparse_solve
   use sla_model, only : element_model, model_factor, model_settled, model_solve
   use sla_scan, only : bring_all
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: guard_every, guard_residual, residual

   integer, parameter :: guard_every = 500            !! events
   real(wp), parameter :: most_residual = 1.0e-8_wp

contains

   !> Residuals of both displacements by the elements; refine, then factorise anew, only where they ask for it
   subroutine guard_residual(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer(c_int) :: node, direction
      real(wp) :: ratio
      integer :: n

      n = model%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%guard(1) = model%guard(1) + 1
      call residual(model, model%ua, model%ub)
      if (model%residual <= most_residual) then
         call model_settled(model)
         return
      end if
      model%guard(2) = model%guard(2) + 1
      status = extrados_sparse_solve(model%handle, 2_c_int, model%z)
      if (status /= status_ok) return
      model%ua(1:n) = model%ua(1:n) + model%z(:, 1)
      model%ub(1:n) = model%ub(1:n) + model%z(:, 2)
      call model_settled(model)
      call residual(model, model%ua, model%ub)
      if (model%residual <= most_residual) return
      model%guard(3) = model%guard(3) + 1
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
      if (status == status_ok) call residual(model, model%ua, model%ub)
   end subroutine guard_residual

   !> Residual forces into z, the larger relative norm into model%residual
   subroutine residual(model, ua, ub)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp) :: load
      integer :: k, g, n
      n = model%equations
      model%residual = 0.0_wp
      do k = 1, 2
         model%force = 0.0_wp
         do g = 1, size(model%holders)
            if (k == 1) call model%holders(g)%group%force(ua, model%force)
            if (k == 2) call model%holders(g)%group%force(ub, model%force)
         end do
         if (k == 1) model%z(:, k) = model%fa(1:n) + model%fo(1:n) + model%fh(1:n, 1) - model%force(1:n)
         if (k == 2) model%z(:, k) = model%fb(1:n) + model%fh(1:n, 2) - model%force(1:n)
         load = merge(norm2(model%fa), norm2(model%fb), k == 1) + norm2(model%reaction(:, k))
         if (load > 0.0_wp) model%residual = max(model%residual, norm2(model%z(:, k)) / load)
      end do
   end subroutine residual

end module sla_guard
