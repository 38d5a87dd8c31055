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

      n = model%mesh%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%checks%checks = model%checks%checks + 1
      call residual(model, model%solution%ua, model%solution%ub)
      if (model%checks%residual <= most_residual) then
         call model_settled(model)
         return
      end if
      model%checks%solutions = model%checks%solutions + 1
      status = extrados_sparse_solve(model%stiffness%factor, 2_c_int, model%solution%z)
      if (status /= status_ok) return
      model%solution%ua(1:n) = model%solution%ua(1:n) + model%solution%z(:, 1)
      model%solution%ub(1:n) = model%solution%ub(1:n) + model%solution%z(:, 2)
      call model_settled(model)
      call residual(model, model%solution%ua, model%solution%ub)
      if (model%checks%residual <= most_residual) return
      model%checks%factors = model%checks%factors + 1
      call model_factor(model, node, direction, ratio, status)
      if (status == status_ok) call model_solve(model, status)
      if (status == status_ok) call residual(model, model%solution%ua, model%solution%ub)
   end subroutine guard_residual

   !> Residual forces into z, the larger relative norm into model%checks%residual
   subroutine residual(model, ua, ub)
      type(element_model), intent(inout) :: model
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp) :: load
      integer :: k, g, n
      n = model%mesh%equations
      model%checks%residual = 0.0_wp
      associate (loads => model%load, z => model%solution%z, force => model%solution%force)
         do k = 1, 2
            force = 0.0_wp
            do g = 1, size(model%mesh%holders)
               if (k == 1) call model%mesh%holders(g)%group%force(ua, force)
               if (k == 2) call model%mesh%holders(g)%group%force(ub, force)
            end do
            if (k == 1) z(:, k) = loads%fa(1:n) + loads%fo(1:n) + loads%fh(1:n, 1) - force(1:n)
            if (k == 2) z(:, k) = loads%fb(1:n) + loads%fh(1:n, 2) - force(1:n)
            load = merge(norm2(loads%fa), norm2(loads%fb), k == 1) + norm2(model%support%reaction(:, k))
            if (load > 0.0_wp) model%checks%residual = max(model%checks%residual, norm2(z(:, k)) / load)
         end do
      end associate
   end subroutine residual

end module sla_guard
