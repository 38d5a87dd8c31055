!> Force release: the forces that a tooth sets free go onto the others at the load reached, before it grows again.
module sla_release
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use sla_group, only : scan_result
   use sla_ledger, only : follow_supports
   use sla_model, only : element_model
   use sla_scan, only : bring_all, choose_event, scan_way
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: hold_state, set_free

contains

   !> Keep the state in which a tooth is about to pass, from which its forces are set free
   subroutine hold_state(model, status)
      type(element_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer :: info
      call bring_all(model, status)
      if (status /= status_ok) return
      model%search%tree%settled = .false.
      associate (way => model%release, ua => model%solution%ua, ub => model%solution%ub)
         if (.not. allocated(way%from)) then
            allocate (way%from, mold=ua, stat=info)
            if (info /= 0) status = status_out_of_memory
            if (info /= 0) return
         end if
         if (way%active) then
            way%from(:) = way%from + way%part * (ua + model%loop%lambda * ub - way%from)
         else
            way%from(:) = ua + model%loop%lambda * ub
         end if
         way%active = .true.
         way%part = 0.0_wp
      end associate
   end subroutine hold_state

   !> Go the straight way from the state held to that of equilibrium at the load reached, up to the first point that
   !> leaves its strength on it, which is the next to be damaged; model%release%active is false at the end of the way
   subroutine set_free(model, found, status)
      type(element_model), intent(inout) :: model
      type(scan_result), intent(out) :: found
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: way(:)
      real(wp) :: lambda, load, excess, total, part
      integer :: g, n, info

      n = model%mesh%equations
      call bring_all(model, status)
      if (status /= status_ok) return
      model%search%tree%settled = .false.
      if (size(model%support%moved, 1) > 0) call follow_supports(model)
      allocate (way, mold=model%solution%ua, stat=info)
      if (info /= 0) status = status_out_of_memory
      if (info /= 0) return
      way(:) = model%solution%ua + model%loop%lambda * model%solution%ub - model%release%from
      call scan_way(model, model%release%from, way, model%loop%lambda, found)
      part = 1.0_wp
      if (found%empty%point /= 0) then
         part = 0.0_wp
         call choose_event(model, found%empty)
      else if (found%hi%value < 1.0_wp) then
         part = max(found%hi%value, 0.0_wp)
         call choose_event(model, found%hi)
      end if
      lambda = model%ledger%lambda
      model%loop%lambda = lambda
      model%release%part = part
      ! Energy: the loads go on at their value; what is above that of equilibrium is lost on the way
      associate (force => model%solution%force, work => model%solution%work, ledger => model%ledger, &
         support => model%support)
         force = 0.0_wp
         do g = 1, size(model%mesh%holders)
            call model%mesh%holders(g)%group%force(way, force)
         end do
         excess = 0.5_wp * dot_product(way(1:n), force(1:n))
         load = dot_product(model%load%fa(1:n) + lambda * model%load%fb(1:n), way(1:n))
         total = work%aa + lambda * (2.0_wp * work%ab + lambda * work%bb)
         ledger%external = ledger%external + part * load
         ledger%dissipated = ledger%dissipated + excess * (1.0_wp - (1.0_wp - part)**2)
         model%release%stored = 0.5_wp * total - (1.0_wp - part) * load + (1.0_wp - part)**2 * excess
         model%release%force = support%work%ab + lambda * support%work%bb - &
            (1.0_wp - part) * dot_product(force(n + 1:), support%moved(:, 2))
         model%loop%event%rank = 0
         model%release%active = part < 1.0_wp
         if (model%release%active) return
         ledger%work = work
         ledger%support_work = support%work
      end associate
   end subroutine set_free

end module sla_release
