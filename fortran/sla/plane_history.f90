!> Points of plane stress that follow their coaxial law (sla_coaxial) without teeth: the responses of plane elements and
!> shells in equilibrium iterations, by the strains and nodal forces of their kind.
module sla_plane_history
   use common_kinds, only : wp
   use common_lists, only : law_yielding => sla_law_yielding, rotating => sla_cracking_rotating
   use common_status, only : status_ok, status_out_of_memory
   use sla_coaxial, only : by_frozen, by_secant, by_tangent, coaxial_law, coaxial_response, coaxial_state
   use sla_group, only : most_entries
   use sla_plane_points, only : axis_free, is_bedded, most_per, plane_points, set_band
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: plane_history, begin_plane, respond_plane, update_plane, show_plane, set_elastic, respond_elastic

   type, abstract, extends(plane_points) :: plane_history
      !> (freedoms, freedoms, elements) matrices of elements without damage [N/m]
      real(wp), allocatable :: elastic(:, :, :)
   contains
      procedure :: continues
      procedure :: begin
      procedure :: respond => respond_plane
      procedure :: update => update_plane
      procedure :: go_ahead
      procedure :: show => show_plane
   end type plane_history

contains

   !> Isotropic masonry with rotating cracks whose shear stiffness follows them
   pure function continues(group) result(yes)
      class(plane_history), intent(in) :: group
      logical :: yes
      integer :: e
      yes = .true.
      do e = 1, group%elements
         if (group%table(e) == 0 .and. group%crush_table(e) == 0) cycle
         yes = yes .and. group%options%cracking == rotating .and. group%axis(e) == axis_free .and. &
            group%options%retention < 0.0_wp .and. .not. is_bedded(group, e) .and. &
            .not. group%bed(e)%crush > 0.0_wp .and. .not. group%lateral(e) > 0.0_wp .and. &
            .not. group%confinement(e) > 0.0_wp
         if (group%table(e) /= 0) yes = yes .and. group%teeth%law(group%table(e))%kind /= law_yielding
      end do
   end function continues

   !> The material of a point
   pure function law_of(group, e, p) result(law)
      class(plane_history), intent(in) :: group
      integer, intent(in) :: e, p
      type(coaxial_law) :: law
      law%young = group%young(e)
      law%nu = group%nu(e)
      law%floor = group%options%floor
      law%cracks = group%table(e) /= 0
      law%crushes = group%crush_table(e) /= 0
      if (law%cracks) law%tension = group%teeth%law(group%table_of(e, p, 1))
      if (law%crushes) law%compression = group%teeth%law(group%crush_table(e))
   end function law_of

   !> See history_group
   subroutine begin(group, u, status)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      integer(c_int), intent(out) :: status
      call begin_plane(group, u, 2, status)
      if (status == status_ok) call set_elastic(group, status)
   end subroutine begin

   !> Histories by the softer of both directions
   subroutine begin_plane(group, u, rows, status)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      integer, intent(in) :: rows              !! of a point, the first two of which are those of its law
      integer(c_int), intent(out) :: status
      type(coaxial_law) :: law
      integer :: e, p
      call group%new_histories(rows, status)
      if (status /= status_ok .or. size(u) == 0) return
      do p = 1, group%points
         e = (p - 1) / group%per + 1
         law = law_of(group, e, p)
         associate (teeth => group%teeth, floor => group%options%floor)
            if (law%cracks) group%history(1, p) = law%tension%strain_at(teeth%modulus_of(group%table_of(e, p, 1), &
               maxval(group%tooth(:, p)), law%young, floor))
            if (law%crushes) group%history(2, p) = law%compression%strain_at(teeth%modulus_of(group%crush_table(e), &
               maxval(group%crush(:, p)), law%young, floor))
         end associate
      end do
      call group%keep()
      group%rate(:, :) = 0.0_wp
   end subroutine begin_plane

   !> Matrices of the elements without damage; the histories of the others stay away from them
   subroutine set_elastic(group, status)
      class(plane_history), intent(inout) :: group
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: elastic(:, :, :)
      real(wp) :: none(most_entries), f(most_entries), energy
      integer :: e, info
      if (allocated(group%elastic)) deallocate (group%elastic)
      allocate (elastic(group%freedoms, group%freedoms, group%elements), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
      if (info /= 0) return
      none = 0.0_wp
      do e = 1, group%elements
         call group%respond(e, none, by_frozen, f, elastic(:, :, e), energy)
      end do
      call move_alloc(elastic, group%elastic)
   end subroutine set_elastic

   !> Response of an element that has no damage and comes to none by these displacements: linear
   pure subroutine respond_elastic(group, e, local, how, f, k, energy, found)
      class(plane_history), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      real(wp), intent(out) :: f(:)
      real(wp), intent(out) :: k(:, :)
      real(wp), intent(out) :: energy
      logical, intent(out) :: found            !! else there is no response here
      integer :: j, n
      f = 0.0_wp
      energy = 0.0_wp
      found = stays_elastic(group, e, local, how)
      if (.not. found) return
      n = group%freedoms
      do j = 1, n
         f(1:n) = f(1:n) + group%elastic(:, j, e) * local(j)
      end do
      energy = 0.5_wp * dot_product(f(1:n), local(1:n))
      if (size(k) > 0) k(1:n, 1:n) = group%elastic(:, :, e)
   end subroutine respond_elastic

   !> Are an element's histories, and its strains where histories follow them, below all peaks?
   pure function stays_elastic(group, e, local, how) result(yes)
      class(plane_history), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      logical :: yes
      real(wp) :: eps(3, most_per), most(2), mean, radius
      integer :: j, p
      yes = allocated(group%elastic)
      if (.not. yes) return
      most = huge(1.0_wp)
      if (group%table(e) /= 0) most(1) = group%teeth%law(group%table(e))%peak
      if (group%crush_table(e) /= 0) most(2) = group%teeth%law(group%crush_table(e))%peak
      do p = (e - 1) * group%per + 1, e * group%per
         yes = yes .and. group%cracked(p) == 0 .and. all(group%history(1:2, p) <= most)
      end do
      if (.not. yes .or. how == by_frozen) return
      call group%strains(e, local, eps)
      do j = 1, group%per
         mean = 0.5_wp * (eps(1, j) + eps(2, j)) / (1.0_wp - group%nu(e))
         radius = 0.5_wp * hypot(eps(1, j) - eps(2, j), eps(3, j)) / (1.0_wp + group%nu(e))
         yes = yes .and. mean + radius <= most(1) .and. radius - mean <= most(2)
      end do
   end function stays_elastic

   pure subroutine respond_plane(group, e, local, how, f, k, energy)
      class(plane_history), intent(in) :: group
      integer, intent(in) :: e
      real(wp), intent(in) :: local(:)
      integer, intent(in) :: how
      real(wp), intent(out) :: f(:)
      real(wp), intent(out) :: k(:, :)
      real(wp), intent(out) :: energy
      real(wp) :: eps(3, most_per), b(most_entries, 3), db(most_entries, 3)
      type(coaxial_state) :: state
      integer :: p, i, n
      logical :: found
      call respond_elastic(group, e, local, how, f, k, energy, found)
      if (found) return
      n = group%freedoms
      k = 0.0_wp
      call group%strains(e, local, eps)
      do p = (e - 1) * group%per + 1, e * group%per
         call coaxial_response(law_of(group, e, p), eps(:, p - (e - 1) * group%per), group%history(1:2, p), how, state)
         call group%nodal(e, p, [1.0_wp, 0.0_wp, 0.0_wp], b(:, 1))
         call group%nodal(e, p, [0.0_wp, 1.0_wp, 0.0_wp], b(:, 2))
         call group%nodal(e, p, [0.0_wp, 0.0_wp, 1.0_wp], b(:, 3))
         energy = energy + group%weight(p) * state%energy
         do i = 1, n
            f(i) = f(i) + group%weight(p) * (b(i, 1) * state%sigma(1) + b(i, 2) * state%sigma(2) + &
               b(i, 3) * state%sigma(3))
         end do
         if (size(k) == 0) cycle
         do i = 1, n
            db(i, :) = group%weight(p) * matmul(b(i, :), state%matrix)
         end do
         do i = 1, n
            k(1:n, i) = k(1:n, i) + db(1:n, 1) * b(i, 1) + db(1:n, 2) * b(i, 2) + db(1:n, 3) * b(i, 3)
         end do
      end do
   end subroutine respond_plane

   !> See history_group
   pure subroutine update_plane(group, u, lost)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: lost
      call grow_histories(group, u, lost)
   end subroutine update_plane

   !> See history_group
   pure subroutine go_ahead(group, u, ratio, lost)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(in) :: ratio
      real(wp), intent(inout) :: lost
      call grow_histories(group, u, lost, ratio)
   end subroutine go_ahead

   !> Histories grow to the displacements, or by a `ratio` of their growth in the last loop, and the energy that this costs.
   !> That of one open crack is that of its law; a second one in tension shares the damage of the first and loses in
   !> proportion to the square of its strain
   pure subroutine grow_histories(group, u, lost, ratio)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp), intent(inout) :: lost          !! [J]
      real(wp), intent(in), optional :: ratio
      real(wp) :: local(most_entries), eps(3, most_per), gain(2)
      type(coaxial_law) :: law
      type(coaxial_state) :: state
      integer :: e, p
      do e = 1, group%elements
         call group%gather(e, u, local)
         call group%strains(e, local, eps)
         do p = (e - 1) * group%per + 1, e * group%per
            law = law_of(group, e, p)
            call coaxial_response(law, eps(:, p - (e - 1) * group%per), group%history(1:2, p), by_secant, state)
            associate (history => group%history(1:2, p), before => group%before_loop(1:2, p))
               if (present(ratio)) state%history = history + ratio * (history - before)
               gain = law%lost_energy(state%history) - law%lost_energy(history)
               lost = lost + group%weight(p) * (gain(1) * (1.0_wp + state%shared) + gain(2))
               history = state%history
            end associate
            if (law%cracks .and. group%cracked(p) == 0 .and. state%history(1) > law%tension%peak) then
              call fix_band(group, e, p, law, state%normal)
            end if
         end do
      end do
   end subroutine grow_histories

   !> The crack band of a point that has cracked; the damage stays
   pure subroutine fix_band(group, e, p, law, normal)
      class(plane_history), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      type(coaxial_law), intent(in) :: law
      real(wp), intent(in) :: normal(2)
      real(wp) :: modulus(2)
      type(coaxial_law) :: new
      group%turn(:, p) = normal
      group%cracked(p) = 1
      call set_band(group, e, p)
      new = law_of(group, e, p)
      if (abs(new%tension%range - law%tension%range) <= 0.0_wp) return
      modulus = law%moduli(group%history(1:2, p))
      group%history(1, p) = new%tension%strain_at(modulus(1))
   end subroutine fix_band

   pure subroutine show_plane(group, u)
      class(plane_history), intent(inout) :: group
      real(wp), intent(in) :: u(0:)
      real(wp) :: local(most_entries), eps(3, most_per), modulus(2)
      type(coaxial_law) :: law
      type(coaxial_state) :: state
      integer :: e, p
      do e = 1, group%elements
         call group%gather(e, u, local)
         call group%strains(e, local, eps)
         do p = (e - 1) * group%per + 1, e * group%per
            law = law_of(group, e, p)
            call coaxial_response(law, eps(:, p - (e - 1) * group%per), group%history(1:2, p), by_frozen, state)
            modulus = law%moduli(group%history(1:2, p))
            if (law%cracks) group%tooth(:, p) = group%teeth%tooth_of(group%table_of(e, p, 1), modulus(1))
            if (law%crushes) group%crush(:, p) = group%teeth%tooth_of(group%crush_table(e), modulus(2))
            if (group%cracked(p) == 0) then
               if (all(modulus >= law%young)) cycle
               if (law%cracks) call fix_band(group, e, p, law, state%normal)
               group%cracked(p) = max(group%cracked(p), 1_c_int)
            end if
            group%turn(:, p) = state%normal
            group%shut(:, p) = merge(1_c_int, 0_c_int, state%principal <= 0.0_wp)
            group%stiff(:, p) = state%stiff
         end do
      end do
   end subroutine show_plane

end module sla_plane_history
