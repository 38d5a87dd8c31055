!> Joints that follow Coulomb's law (sla_joint_law) without teeth: their responses in equilibrium iterations. In the
!> plane a joint slides along itself; between shells along the joint and out of their plane.
module sla_joint_history
   use common_kinds, only : wp
   use common_status, only : status_ok
   use sla_coaxial, only : by_secant, by_tangent
   use sla_group, only : damage_rows, most_entries
   use sla_joint_law, only : joint_material, joint_response, joint_rows, joint_state
   use sla_joint_points, only : bond, bond_of, is_closed, joint_points, jump, nodal, shear, slides_up, slides_down, &
      sticks
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: joint_history

   type, abstract, extends(joint_points) :: joint_history
   contains
      procedure :: continues
      procedure :: begin
      procedure :: respond
      procedure :: couple
      procedure :: update
      procedure :: go_ahead
      procedure :: show
   end type joint_history

contains

   pure function continues(group) result(yes)
      class(joint_history), intent(in) :: group
      logical :: yes
      yes = group%points >= 0
   end function continues

   !> The material of an element
   pure function law_of(group, e) result(law)
      class(joint_history), intent(in) :: group
      integer, intent(in) :: e
      type(joint_material) :: law
      associate (own => group%law, teeth => group%teeth)
         law%kn = own%kn(e)
         law%ks = own%ks(e)
         law%friction = own%friction(e)
         law%floor = group%options%floor
         law%cracks = own%table(e) /= 0
         law%pulls = own%table(e) == 0 .and. own%dry(e) == 0
         law%crushes = own%crush_table(e) /= 0
         law%coheres = own%slip_table(e) /= 0
         if (law%cracks) law%tension = teeth%law(own%table(e))
         if (law%crushes) law%compression = teeth%law(own%crush_table(e))
         if (law%coheres) law%cohesion = teeth%law(own%slip_table(e))
      end associate
   end function law_of

   !> Jumps across, along and, between shells, out of the plane [m]
   pure function jumps(group, e, p, local) result(d)
      class(joint_history), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: local(:)
      real(wp) :: d(3)
      d = 0.0_wp
      d(1:2) = jump(group, e, p, local)
      if (allocated(group%row)) d(3) = dot_product(group%row(:, 3, p), local(1:group%freedoms))
   end function jumps

   !> Vectors whose products with the displacements are the jumps
   pure function vectors_of(group, e, p) result(b)
      class(joint_history), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp) :: b(most_entries, 3)
      b(:, 1) = nodal(group, e, p, [1.0_wp, 0.0_wp])
      b(:, 2) = nodal(group, e, p, [0.0_wp, 1.0_wp])
      b(:, 3) = 0.0_wp
      if (allocated(group%row)) b(1:group%freedoms, 3) = group%row(:, 3, p)
   end function vectors_of

   !> Histories by the teeth and the slip so far
   subroutine begin(group, u, status)
      class(joint_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      integer(c_int), intent(out) :: status
      real(wp) :: local(most_entries), d(3)
      type(joint_material) :: law
      type(joint_state) :: state
      integer :: e, p
      call group%new_histories(joint_rows, status)
      if (status /= status_ok) return
      do e = 1, group%elements
         law = law_of(group, e)
         call group%gather(e, u, local)
         do p = 2 * e - 1, 2 * e
            associate (history => group%history(:, p), teeth => group%teeth)
               d = jumps(group, e, p, local)
               if (law%cracks) history(1) = law%tension%strain_at(teeth%modulus_of(group%law%table(e), &
                  group%tooth(p), law%kn, 0.0_wp))
               if (law%crushes) history(2) = law%compression%strain_at(teeth%modulus_of(group%law%crush_table(e), &
                  group%crush(p), law%kn, 0.0_wp))
               if (law%coheres) history(3) = law%cohesion%strain_at(teeth%modulus_of(group%law%slip_table(e), &
                  group%slip(p), law%ks, 0.0_wp))
               if (law%friction >= 0.0_wp) then
                  history(4) = d(2)
                  if (is_closed(group, p)) history(4) = (1.0_wp - bond(group, e, p) / shear(group, e, p)) * &
                     group%mark(p)
               end if
               group%kept(:, p) = history
               call joint_response(law, d, history, history, by_secant, state)
               history(6) = state%history(6)
               history(8) = state%history(8)
            end associate
         end do
      end do
      call group%keep()
      group%rate(:, :) = 0.0_wp
   end subroutine begin

   pure subroutine respond(group, e, local, how, f, k, energy)
      class(joint_history), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      real(wp), intent(out) :: f(:)
      real(wp), intent(out) :: k(:, :)
      real(wp), intent(out) :: energy
      real(wp) :: b(most_entries, 3), c(most_entries, 3), d(3, 3)
      type(joint_state) :: state
      type(joint_material) :: law
      integer :: p, i, n
      n = group%freedoms
      f = 0.0_wp
      k = 0.0_wp
      energy = 0.0_wp
      law = law_of(group, e)
      do p = 2 * e - 1, 2 * e
         if (.not. group%area(p) > 0.0_wp) cycle
         call joint_response(law, jumps(group, e, p, local), group%kept(:, p), group%history(:, p), how, state)
         b = vectors_of(group, e, p)
         energy = energy + group%area(p) * state%energy
         d = 0.0_wp
         d(1, 1) = state%matrix(1, 1)
         d(2:3, 2:3) = state%matrix(2:3, 2:3)
         do i = 1, n
            f(i) = f(i) + group%area(p) * dot_product(b(i, :), state%stress)
            c(i, :) = group%area(p) * matmul(b(i, :), d)
         end do
         if (size(k) == 0) cycle
         do i = 1, n
            k(1:n, i) = k(1:n, i) + c(1:n, 1) * b(i, 1) + c(1:n, 2) * b(i, 2) + c(1:n, 3) * b(i, 3)
         end do
      end do
   end subroutine respond

   pure subroutine couple(group, e, local, k, couples)
      class(joint_history), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      real(wp), intent(out) :: k(:, :)
      logical, intent(out) :: couples
      real(wp) :: b(most_entries, 3), c(most_entries), g(most_entries)
      type(joint_state) :: state
      type(joint_material) :: law
      integer :: p, i, n
      n = group%freedoms
      couples = .false.
      law = law_of(group, e)
      do p = 2 * e - 1, 2 * e
         if (.not. group%area(p) > 0.0_wp) cycle
         call joint_response(law, jumps(group, e, p, local), group%kept(:, p), group%history(:, p), by_tangent, state)
         if (.not. any(abs([state%matrix(1, 2:3), state%matrix(2:3, 1)]) > 0.0_wp)) cycle
         if (.not. couples) k = 0.0_wp
         couples = .true.
         b = vectors_of(group, e, p)
         c(1:n) = group%area(p) * (state%matrix(2, 1) * b(1:n, 2) + state%matrix(3, 1) * b(1:n, 3))
         g(1:n) = group%area(p) * (state%matrix(1, 2) * b(1:n, 2) + state%matrix(1, 3) * b(1:n, 3))
         do i = 1, n
            k(1:n, i) = k(1:n, i) + c(1:n) * b(i, 1) + b(1:n, 1) * g(i)
         end do
      end do
   end subroutine couple

   !> See history_group
   pure subroutine update(group, u, lost)
      class(joint_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: lost
      real(wp) :: local(most_entries)
      type(joint_material) :: law
      type(joint_state) :: state
      integer :: e, p
      do e = 1, group%elements
         law = law_of(group, e)
         call group%gather(e, u, local)
         do p = 2 * e - 1, 2 * e
            if (.not. group%area(p) > 0.0_wp) cycle
            call joint_response(law, jumps(group, e, p, local), group%kept(:, p), group%history(:, p), by_secant, &
               state)
            lost = lost + group%area(p) * (state%history(7) - group%history(7, p))
            group%history(:, p) = state%history
         end do
      end do
   end subroutine update

   !> See history_group: the damage alone. The next update counts its energy, from the start of the step
   pure subroutine go_ahead(group, u, ratio, lost)
      class(joint_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(in) :: ratio
      real(wp), intent(inout) :: lost
      associate (unused_u => u, unused_lost => lost, now => group%history(1:damage_rows, :))
         now(:, :) = now + ratio * (now - group%before_loop(1:damage_rows, :))
      end associate
   end subroutine go_ahead

   pure subroutine show(group, u)
      class(joint_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp) :: local(most_entries), d(3), left
      type(joint_material) :: law
      type(joint_state) :: state
      integer :: e, p
      do e = 1, group%elements
         law = law_of(group, e)
         call group%gather(e, u, local)
         do p = 2 * e - 1, 2 * e
            d = jumps(group, e, p, local)
            call joint_response(law, d, group%kept(:, p), group%history(:, p), by_secant, state)
            associate (own => group%law, teeth => group%teeth, x => law%progress(group%history(:, p)))
               if (law%cracks .and. x > 0.0_wp) group%tooth(p) = teeth%tooth_of(own%table(e), &
                  law%tension%secant(law%tension%strain_of(x)))
               if (law%coheres .and. x > 0.0_wp) group%slip(p) = teeth%tooth_of(own%slip_table(e), &
                  law%cohesion%secant(law%cohesion%strain_of(x)))
               if (law%crushes) group%crush(p) = teeth%tooth_of(own%crush_table(e), &
                  law%compression%secant(group%history(2, p)))
            end associate
            group%shut(p) = merge(1_c_int, 0_c_int, d(1) <= 0.0_wp)
            group%held(:, p) = 0.0_wp
            group%start(p) = 0.0_wp
            group%mode(p) = sticks
            left = shear(group, e, p) - bond(group, e, p)
            if (law%friction >= 0.0_wp .and. left > 0.0_wp) then
              group%mark(p) = d(2) - (state%stress(2) - bond(group, e, p) * d(2)) / left
            end if
         end do
      end do
   end subroutine show

end module sla_joint_history
